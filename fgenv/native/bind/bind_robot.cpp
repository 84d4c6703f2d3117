// Python class of a kinematic tree: configurations in, poses out.
#include "bind/bind.h"

#include <nanobind/stl/vector.h>

#include "bind/arguments.h"
#include "bind/configurations.h"
#include "bind/parallel.h"
#include "robot/link_motion.h"

namespace fgenv {
namespace {

using namespace nb::literals;

constexpr double greatest_position = 1e12;  // meters, as for poses
constexpr double greatest_joint = 1e5;      // limit of sin_cos in radians; or meters
constexpr size_t most_links = 1000;         // motions recurse from link to link

[[noreturn]] void fail(const std::string& text) { throw nb::value_error(text.c_str()); }

// A rotation close to the given matrix: scale and shear must not accumulate along a chain of joints.
Rigid orthonormal(Rigid m) {
    Vec3 x = unit({m.r[0][0], m.r[1][0], m.r[2][0]}), y{m.r[0][1], m.r[1][1], m.r[2][1]};
    y = unit(y - dot(x, y) * x);
    const Vec3 z = cross(x, y);
    for (int i = 0; i < 3; ++i) {
        m.r[i][0] = coordinate(x, i);
        m.r[i][1] = coordinate(y, i);
        m.r[i][2] = coordinate(z, i);
    }
    return m;
}

// The Python interface has checked the arguments; only bounds are checked again.
void make_robot(Robot* self, const std::vector<int>& kinds, const std::vector<int>& parents, nb::handle origins,
                nb::handle axes, const std::vector<int>& firsts, const std::vector<double>& multipliers,
                const std::vector<double>& offsets, std::vector<std::string> names) {
    const Poses place = poses(origins, "origins");
    const Array<double> axis = points(axes, "axes");
    const size_t n = kinds.size();
    if (n == 0 || place.size() != n || axis.view.size() != 3 * n || parents.size() != n || firsts.size() != n ||
        multipliers.size() != n || offsets.size() != n)
        fail("joints: got lists of different lengths, expected one entry for the base and per joint");
    if (n > most_links) fail("links: got " + std::to_string(n) + ", expected at most " + std::to_string(most_links));
    Robot robot;
    robot.coordinates.assign(names.size(), Coordinate::linear);
    robot.most.assign(names.size(), greatest_joint);
    for (size_t i = 0; i < n; ++i) {
        Joint joint;
        if (kinds[i] < 0 || kinds[i] > 5) fail("kinds: got " + std::to_string(kinds[i]) + ", expected 0 to 5");
        joint.kind = static_cast<JointKind>(kinds[i]);
        joint.parent = parents[i];
        joint.first = firsts[i];
        const bool base = joint.parent < 0,
                   base_kind = joint.kind == JointKind::planar || joint.kind == JointKind::free;
        if (base != (i == 0) || joint.parent >= static_cast<int>(i) || (base_kind && !base))
            fail("parents: got another order, expected the base first, and parents before their children");
        if (joint.first < 0 || joint.first + size(joint.kind) > static_cast<int>(names.size()))
            fail("firsts: got an index out of range, expected the index of a coordinate");
        joint.origin = orthonormal(place[i]);
        const double* a = axis.data() + 3 * i;
        joint.axis = a[0] == 0 && a[1] == 0 && a[2] == 0 ? Vec3{0, 0, 1} : direction_of(a);
        joint.multiplier = multipliers[i];
        joint.offset = offsets[i];
        if (!(std::fabs(joint.multiplier) <= greatest_joint && std::fabs(joint.offset) <= greatest_joint))
            fail("multipliers, offsets: got numbers out of range, expected at most " + number(greatest_joint));
        if (joint.kind == JointKind::continuous) robot.coordinates[joint.first] = Coordinate::angle;
        if (base_kind) {
            for (int k = 0; k < 3; ++k) robot.most[joint.first + k] = greatest_position;
            if (joint.kind == JointKind::planar) robot.coordinates[joint.first + 2] = Coordinate::angle;
            for (int k = 3; k < size(joint.kind); ++k) robot.coordinates[joint.first + k] = Coordinate::rotation;
            if (joint.kind == JointKind::planar) robot.most[joint.first + 2] = greatest_joint;
        }
        robot.joints.push_back(joint);
    }
    robot.names = std::move(names);
    new (self) Robot(std::move(robot));
}

nb::object forward_all(const Robot& robot, nb::handle q, nb::handle threads) {
    const Configurations c = configurations(robot, q, "q");
    const int n_threads = threads_of(threads);
    const int32_t links = robot.n_links();
    Output<double> out = make_output<double>(c.dims, {links, 4, 4});
    const auto run = [&](int64_t first, int64_t last) {
        std::vector<Rigid> poses(links);
        for (int64_t i = first; i < last; ++i) {
            forward(robot, c.row(i), poses.data());
            for (int32_t k = 0; k < links; ++k) write_pose(poses[k], out.data + 16 * (i * links + k));
        }
    };
    if (c.dims.empty())
        run(0, 1);
    else
        parallel_for(broadcast({{"q", c.dims}}).size, n_threads, run);
    return nb::cast(out.array);
}

// Two configurations and a fraction of the motion, broadcast.
struct Way {
    Configurations from, to;
    Array<double> t;
    Broadcast shape;

    const double* q0(int64_t i) const { return from.row(shape.offset(0, i)); }
    const double* q1(int64_t i) const { return to.row(shape.offset(1, i)); }
    double fraction(int64_t i) const { return t.data()[shape.offset(2, i)]; }
};

Way way_of(const Robot& robot, nb::handle q0, nb::handle q1, nb::handle t) {
    Way out{configurations(robot, q0, "q0"), configurations(robot, q1, "q1"), doubles(t, "t"), {}};
    for (size_t i = 0; i < out.t.view.size(); ++i)
        if (!(out.t.data()[i] >= 0 && out.t.data()[i] <= 1))
            fail(std::string("t") + index_text(out.t.dims, static_cast<int64_t>(i)) + ": got " +
                 number(out.t.data()[i]) + ", expected a fraction from 0 to 1");
    out.shape = broadcast({{"q0", out.from.dims}, {"q1", out.to.dims}, {"t", out.t.dims}});
    return out;
}

nb::object interpolate_all(const Robot& robot, nb::handle q0, nb::handle q1, nb::handle t, nb::handle threads) {
    const Way way = way_of(robot, q0, q1, t);
    const int n_threads = threads_of(threads);
    Output<double> out = make_output<double>(way.shape.dims, {robot.nq()});
    const auto run = [&](int64_t first, int64_t last) {
        for (int64_t i = first; i < last; ++i)
            interpolate(robot, way.q0(i), way.q1(i), way.fraction(i), out.data + i * robot.nq());
    };
    if (way.shape.dims.empty())
        run(0, 1);
    else
        parallel_for(way.shape.size, n_threads, run);
    return nb::cast(out.array);
}

nb::object displacement_bounds(const Robot& robot, nb::handle q0, nb::handle q1, nb::handle weights) {
    const Configurations from = configurations(robot, q0, "q0"), to = configurations(robot, q1, "q1");
    const Array<double> w = doubles(weights, "weights");
    if (w.dims != Dims{robot.nq()})
        fail("weights: got shape " + to_string(w.dims) + ", expected (" + std::to_string(robot.nq()) + ",)");
    const Broadcast shape = broadcast({{"q0", from.dims}, {"q1", to.dims}});
    if (shape.dims.empty()) return nb::cast(displacement_bound(robot, w.data(), from.row(0), to.row(0)));
    Output<double> out = make_output<double>(shape.dims);
    parallel_for(shape.size, 0, [&](int64_t first, int64_t last) {
        for (int64_t i = first; i < last; ++i)
            out.data[i] = displacement_bound(robot, w.data(), from.row(shape.offset(0, i)), to.row(shape.offset(1, i)));
    });
    return nb::cast(out.array);
}

nb::tuple link_motion(const Robot& robot, int32_t link, nb::handle q0, nb::handle q1, nb::handle t, nb::handle offset,
                      double begin, double rate, nb::handle threads) {
    const Way way = way_of(robot, q0, q1, t);
    const int n_threads = threads_of(threads);
    if (link < 0 || link >= robot.n_links())
        fail("link: got " + std::to_string(link) + ", expected 0 to " + std::to_string(robot.n_links() - 1));
    if (!(begin >= 0 && rate >= 0 && begin + rate <= 1))
        fail("begin, rate: got " + number(begin) + ", " + number(rate) + ", expected fractions inside [0, 1]");
    Poses held;
    if (!offset.is_none()) held = poses(offset, "offset");
    if (!held.single()) fail("offset: got " + to_string(held.dims) + " poses, expected one, shape (4, 4)");
    const Rigid fixed = offset.is_none() ? identity() : held[0];
    const Rigid* on_link = offset.is_none() ? nullptr : &fixed;
    const Dims& dims = way.shape.dims;
    Output<double> pose = make_output<double>(dims, {4, 4}), v = make_output<double>(dims, {3}),
                   w = make_output<double>(dims, {3}), at_origin = make_output<double>(dims),
                   by_radius = make_output<double>(dims), turn = make_output<double>(dims);
    const auto put = [](Vec3 p, double* row) { row[0] = p.x, row[1] = p.y, row[2] = p.z; };
    parallel_for(way.shape.size, n_threads, [&](int64_t first, int64_t last) {
        for (int64_t i = first; i < last; ++i) {
            const RobotMotion whole(robot, way.q0(i), way.q1(i));
            const LinkMotion motion = LinkMotion(whole, link, on_link).retimed(begin, rate);
            const Velocity velocity = motion.velocity(way.fraction(i));
            write_pose(motion.pose(way.fraction(i)), pose.data + 16 * i);
            put(velocity.v, v.data + 3 * i);
            put(velocity.w, w.data + 3 * i);
            at_origin.data[i] = motion.acceleration().at_origin;
            by_radius.data[i] = motion.acceleration().by_radius;
            turn.data[i] = motion.turn();
        }
    });
    return nb::make_tuple(pose.array, v.array, w.array, at_origin.array, by_radius.array, turn.array);
}

nb::tuple sin_cos_all(nb::handle angles) {
    const Array<double> x = doubles(angles, "angles");
    Output<double> s = make_output<double>(x.dims), c = make_output<double>(x.dims);
    for (size_t i = 0; i < x.view.size(); ++i) {
        if (!(std::fabs(x.data()[i]) <= greatest_joint))
            fail(std::string("angles") + index_text(x.dims, static_cast<int64_t>(i)) + ": got " + number(x.data()[i]) +
                 ", expected radians of at most " + number(greatest_joint));
        sin_cos(x.data()[i], s.data[i], c.data[i]);
    }
    return nb::make_tuple(s.array, c.array);
}

}  // namespace

void bind_robot(nb::module_& m) {
    nb::class_<Robot>(m, "Robot")
        .def("__init__", &make_robot, "kinds"_a, "parents"_a, "origins"_a, nb::kw_only(), "axes"_a, "firsts"_a,
             "multipliers"_a, "offsets"_a, "names"_a)
        .def("forward", &forward_all, "q"_a.none(), "threads"_a.none())
        .def("interpolate", &interpolate_all, "q0"_a.none(), "q1"_a.none(), "t"_a.none(), nb::kw_only(),
             "threads"_a.none())
        .def("displacement_bound", &displacement_bounds, "q0"_a.none(), "q1"_a.none(), "weights"_a)
        .def("link_motion", &link_motion, "link"_a, "q0"_a.none(), "q1"_a.none(), nb::kw_only(), "t"_a.none(),
             "offset"_a.none(), "begin"_a, "rate"_a, "threads"_a.none());
    m.def("sin_cos", &sin_cos_all, "angles"_a.none(), "Sine and cosine, the same bits on every machine.");
    m.def("arc_tangent", &arc_tangent, "y"_a, "x"_a, "Angle of the point (x, y), the same bits on every machine.");
}

}  // namespace fgenv
