// Several threads on one World, under the thread sanitizer: queries share its mutex, changes hold it
// alone. Run by race.sh; with `unlocked` no thread locks, and the sanitizer must report it.
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <random>
#include <shared_mutex>
#include <thread>

#include "world/world.h"

using namespace fgenv;

namespace {

#define LAW(condition)                                                                   \
    do {                                                                                 \
        if (!(condition)) {                                                              \
            std::fprintf(stderr, "%s:%d: broken: %s\n", __FILE__, __LINE__, #condition); \
            std::abort();                                                                \
        }                                                                                \
    } while (false)

bool locking = true;

template <class Lock>
Lock locked(const World& w) {
    return locking ? Lock(w.mutex) : Lock(w.mutex, std::defer_lock);
}
auto reading(const World& w) { return locked<std::shared_lock<FairMutex>>(w); }
auto writing(const World& w) { return locked<std::unique_lock<FairMutex>>(w); }

std::shared_ptr<Shape> make_box(double x, double y, double z) {
    std::vector<Vec3> v;
    for (int k = 0; k < 8; ++k) v.push_back({((k & 1) - 0.5) * x, ((k >> 1 & 1) - 0.5) * y, ((k >> 2) - 0.5) * z});
    static const int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    std::vector<Face> f;
    for (const auto& q : quads) {
        f.push_back({q[0], q[1], q[2]});
        f.push_back({q[0], q[2], q[3]});
    }
    return std::make_shared<Shape>(build_shape(read_mesh(std::move(v), std::move(f)), GraphSettings{}));
}

struct Random {
    std::mt19937_64 engine;
    double number(double reach) { return reach * (double(engine() >> 11) * 0x1p-52 - 1); }
    int below(int n) { return static_cast<int>(engine() % static_cast<uint64_t>(n)); }
    Rigid pose(double reach) {
        Rigid out = turned(identity(), {number(1.5), number(1.5), number(1.5)});
        for (double& t : out.t) t = number(reach);
        return out;
    }
    std::vector<Place> places(int n, double reach) {
        std::vector<Place> out;
        for (int i = 0; i < n; ++i) out.push_back({pose(reach), {}});
        return out;
    }
};

constexpr int bodies = 12;  // permanent bodies; others are added and removed

// One of each query.
double ask(const World& w, Random& random) {
    const Place from{random.pose(2), {}}, to{random.pose(2), {}};
    const BodyId robot = 2 * random.below(bodies / 2);  // the odd ones may be carried
    MotionSettings now_, later;
    later.from = 0;
    later.to = 1;
    const auto lock = reading(w);
    double sum = w.collides(robot, from, 0.5, 0.01);
    sum += w.clearance({robot}, {from}, now).distance;
    BodyPair last;
    sum += w.free_at({robot}, {from}, 0.01, last);
    sum += w.free_on({robot}, {from}, {to}, now_, last);
    sum += w.motions_collide(0, from, to, 4, to, from, now_);
    sum += w.check_motion(robot, from, to, now_).contact.free_until;
    sum += w.check_motion(robot, from, to, later).contact.free_until;
    for (const MotionOutcome& o : w.check_motions({0, 4, 8}, {from, to, from}, {to, from, from}, now_)) sum += o.other;
    sum += w.raycast(origin(from.pose), {1, 0, 0}, 10, {robot}).body;
    std::vector<std::pair<BodyId, BodyId>> pairs;
    for (int32_t block = 0; block < w.blocks(); ++block) w.contact_pairs_of_block(block, 0.1, pairs);
    sum += static_cast<double>(pairs.size());
    for (const auto& [id, path] : w.paths()) sum += path.bit + static_cast<double>(path.candidates.size());
    sum += static_cast<double>(w.body(robot).movers.size() + w.nbytes() % 2 + w.size() % 2);
    return sum;
}

// One of each change; every addition is undone.
void change(World& w, Random& random, const std::shared_ptr<Shape>& shape, const std::string& name) {
    const BodyId even = 2 * random.below(bodies / 2);
    const auto once = [&](auto&& what) {
        const auto lock = writing(w);
        what();
    };
    BodyId mine = -1;
    once([&] { mine = w.add(shape, random.pose(2), name, {"g", name}); });
    once([&] { w.set_poses({mine, even}, {random.pose(2), random.pose(2)}); });
    once([&] { w.set_path(mine, random.places(3, 2)); });
    once([&] { w.set_path(even, random.places(2, 2)); });
    once([&] { w.advance({mine, even}, random.places(2, 2), MotionSettings{}); });
    once([&] { w.allow(mine, even, true); });
    once([&] { w.allow_groups("g", name, random.below(2)); });
    once([&] { w.set_trajectory(mine, {{0, 1}, random.places(2, 2)}); });
    once([&] { w.attach(mine, even); });
    if (random.below(2)) once([&] { w.detach(mine); });
    once([&] { w.clear_path(even); });
    once([&] { w.remove(mine); });
}

// Concurrent queries give the results of a single thread.
void agree(const World& w) {
    constexpr int each = 40;
    const auto series = [&w](int seed, double* out) {
        Random random{std::mt19937_64(seed)};
        for (int i = 0; i < each; ++i) out[i] = ask(w, random);
    };
    double alone[4][each], beside[4][each];
    for (int i = 0; i < 4; ++i) series(i, alone[i]);
    std::vector<std::thread> team;
    for (int i = 0; i < 4; ++i) team.emplace_back(series, i, beside[i]);
    for (std::thread& t : team) t.join();
    LAW(!std::memcmp(alone, beside, sizeof alone));
}

}  // namespace

int main(int count, char** arguments) {
    locking = !(count > 1 && !std::strcmp(arguments[1], "unlocked"));
    const std::shared_ptr<Shape> shapes[] = {make_box(1, 1, 1), make_box(2, 0.1, 0.1), make_box(0.3, 0.5, 0.7)};
    World world(Masks::path);
    Random random{std::mt19937_64(1)};
    for (int i = 0; i < bodies; ++i) world.add(shapes[i % 3], random.pose(2), "", {"g"});
    world.attach(1, 0);
    world.attach(3, 1);
    world.set_trajectory(6, {{0, 1}, random.places(2, 2)});
    world.set_path(0, random.places(3, 2));
    if (locking) agree(world);

    std::atomic<int> changing{2};
    std::atomic<int64_t> asked{0};
    std::vector<std::thread> team;
    for (int i = 0; i < 2; ++i)
        team.emplace_back([&, i] {
            Random own{std::mt19937_64(10 + i)};
            for (int n = 0; n < (locking ? 150 : 5); ++n) {
                change(world, own, shapes[n % 3], "new " + std::to_string(i));
                std::this_thread::yield();
            }
            --changing;
        });
    for (int i = 0; i < 3; ++i)
        team.emplace_back([&, i] {
            Random own{std::mt19937_64(20 + i)};
            while (changing) {
                ask(world, own);
                ++asked;
                if (own.below(8) == 0 && locking) {
                    const auto lock = reading(world);
                    const World twin(world);
                    LAW(twin.size() == world.size());
                }
                std::this_thread::sleep_for(std::chrono::microseconds(200));
            }
        });
    for (std::thread& t : team) t.join();
    LAW(world.size() == bodies);
    agree(world);
    std::printf("%lld rounds of queries beside the changes, %lld pairs tested\n", static_cast<long long>(asked),
                static_cast<long long>(world.tests()));
}
