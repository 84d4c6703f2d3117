// World of moving bodies: masks that select candidate pairs, and exact collision checks.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <span>
#include <string>

#include "motion/certify.h"
#include "robot/mover.h"
#include "world/box_index.h"
#include "world/fair_mutex.h"

namespace fgenv {

using BodyId = int32_t;

// A motion known in advance: `places[i]` at `times[i]` (seconds), interpolated linearly, at rest outside.
struct Trajectory {
    std::vector<double> times;
    std::vector<Place> places;

    // The leg that contains a time, and the fraction along it.
    struct Leg {
        const Place &from, &to;
        double begin, length;  // seconds; a length of 0 means at rest
    };
    Leg leg(double time) const;
};

using OwnPairs = std::vector<std::pair<int32_t, int32_t>>;

// A body is a root or is carried by another body. A root and all the bodies that it carries form a mover. A
// robot's bodies are the shapes of its links; they can carry further bodies.
struct Body {
    BodyId id;
    std::shared_ptr<Shape> shape;
    std::string name;
    Rigid pose;
    Box box;     // at the current pose
    Box extent;  // at the current pose and along its trajectory
    std::vector<int32_t> groups;
    std::vector<BodyId> allowed;  // sorted; contact with these is not a collision
    BodyId carrier = -1, root;
    int32_t link = 0;                        // link of the root, if that is a robot
    Rigid offset = identity();               // pose in the frame of the root or its link
    bool built_in = false;                   // a shape of a robot
    bool present = true;                     // false: excluded from all checks
    std::vector<BodyId> parts;               // for a root: itself, then all carried bodies
    std::vector<BodyId> movers;              // sorted; movers with a motion box that this body overlaps
    std::unique_ptr<Trajectory> trajectory;  // for a root
    std::shared_ptr<const Robot> robot;      // for a root that is a robot
    std::vector<double> q;                   // configuration of `robot`
    OwnPairs own_pairs;                      // tested pairs of `parts`, as indices

    bool stands_for_itself() const { return root == id && !robot; }
    const Rigid* held_at() const { return stands_for_itself() ? nullptr : &offset; }
    Place place() const { return {pose, q}; }
    Rigid in(const Frames& frames) const { return stands_for_itself() ? frames.body : compose(frames[link], offset); }
};

// A shape of a robot.
struct RobotPart {
    std::string link_name;
    int32_t link;
    std::shared_ptr<Shape> shape;
    Rigid offset;
};

struct Path {
    int bit = 0;
    std::vector<Place> places;
    std::vector<Box> legs;           // motion boxes
    std::vector<int32_t> items;      // index items of the legs
    std::vector<BodyId> candidates;  // sorted
};

enum class Masks : uint8_t { path, published, off };

// Time of a query. NaN means now: every body at its set pose.
constexpr double now = std::numeric_limits<double>::quiet_NaN();

struct MotionSettings {
    CertifySettings certify;
    double from = now, to = now;   // seconds at fractions 0 and 1
    double resolution = 0;         // meters; above 0, motions are tested in steps instead of certified
    bool margin_to_itself = true;  // the margin also applies between a robot's own parts

    MotionSettings with_speed(double speed) const {
        MotionSettings out = *this;
        out.certify.speed = speed;
        return out;
    }
};

struct MotionOutcome {
    MotionContact contact;
    BodyId part = -1, other = -1;
    int64_t checks = 0;  // tested pairs of bodies
    int32_t masked = 0;  // candidate bodies under the motion's mask
};

struct Clearance {
    double distance = HUGE_VAL;
    BodyId other = -1;
};

// Two bodies in contact. Planners test the last colliding pair first, since it often collides again.
struct BodyPair {
    BodyId a = -1, b = -1;
};

struct WorldHit {
    double distance = HUGE_VAL;
    BodyId body = -1;
};

struct PlacedMover;
struct SweptPart;
struct SweptMover;
struct InstantTest;
enum class PairOrder : uint8_t;
template <class Part>
struct CandidatePair;

// Number of steps of a motion in which points move up to `length` meters; throws if there are too many.
int64_t steps_of(const MotionSettings& settings, double length);

// Methods throw std::invalid_argument. Const methods may run concurrently. The caller locks `mutex`: shared for
// const methods, exclusive for others.
class World {
public:
    explicit World(Masks masks) : masks_(masks) {}
    World(const World& other);
    ~World();

    BodyId add(std::shared_ptr<Shape> shape, const Rigid& pose, std::string name,
               const std::vector<std::string>& groups, BodyId id = -1);
    // Adds one body per part; the first body's id identifies the robot. `allowed`: pairs of parts that may touch.
    BodyId add_robot(std::shared_ptr<const Robot> robot, std::vector<double> q, const std::vector<RobotPart>& parts,
                     const std::vector<std::pair<int32_t, int32_t>>& allowed, const std::string& name,
                     const std::vector<std::string>& groups);
    std::string unused_name(const std::string& like) const;
    // Returns shapes that may hold a last reference; the caller releases them where Python may be called.
    std::vector<std::shared_ptr<Shape>> remove(BodyId id);
    void set_poses(const std::vector<BodyId>& ids, const std::vector<Rigid>& poses);
    void set_configuration(BodyId robot, std::vector<double> q);
    void set_present(BodyId robot, bool present);  // includes carried bodies; clears the path
    void attach(BodyId id, BodyId carrier);
    void detach(BodyId id);
    // Attachment of a body, restored bit for bit (attaching again would round the offset).
    struct Bond {
        BodyId carrier, root;
        int32_t link;
        Rigid offset;
        bool built_in;
        std::vector<BodyId> parts;
        std::shared_ptr<const Robot> robot;
        std::vector<double> q;
    };
    void restore(BodyId id, Bond bond);
    void allow(BodyId a, BodyId b, bool allowed);
    void allow_groups(const std::string& a, const std::string& b, bool allowed);
    void set_trajectory(BodyId id, Trajectory trajectory);  // without times: removes it

    // Uses the given bit, otherwise the robot's current bit, otherwise the lowest free bit.
    const std::vector<BodyId>& set_path(BodyId robot, std::vector<Place> places, int bit = -1);
    void clear_path(BodyId robot);
    const Path* path(BodyId robot) const;
    const std::map<BodyId, Path>& paths() const { return paths_; }
    int own_bit(BodyId robot) const;

    bool collides(BodyId robot, const Place& place, double time, double margin) const;
    // Smallest distance from these movers to all other bodies and between the movers.
    Clearance clearance(const std::vector<BodyId>& robots, const std::vector<Place>& places, double time) const;
    MotionOutcome check_motion(BodyId robot, const Place& from, const Place& to, const MotionSettings& settings) const;
    // Simultaneous motions, also checked against each other.
    std::vector<MotionOutcome> check_motions(const std::vector<BodyId>& robots, const std::vector<Place>& from,
                                             const std::vector<Place>& to, const MotionSettings& settings) const;
    // Moves all robots simultaneously from their current places. Each stops at its first contact, and later arrivals
    // collide with it there. Free states stay free. With `through`, all robots continue to the end.
    std::vector<MotionOutcome> advance(const std::vector<BodyId>& robots, const std::vector<Place>& to,
                                       const MotionSettings& settings, bool through = false);
    // Checks for planners: whether movers at rest or in simultaneous motion are free of collision, also with each
    // other. The start of a motion is assumed to be free. The margin does not apply between parts of one mover.
    bool free_at(const std::vector<BodyId>& robots, const std::vector<Place>& places, double margin,
                 BodyPair& last) const;
    bool free_on(const std::vector<BodyId>& robots, const std::vector<Place>& from, const std::vector<Place>& to,
                 const MotionSettings& settings, BodyPair& last) const;
    // Whether two simultaneous motions are not certified as separate; ignores all other bodies.
    bool motions_collide(BodyId a, const Place& from_a, const Place& to_a, BodyId b, const Place& from_b,
                         const Place& to_b, const MotionSettings& settings) const;
    // Distances along rays from one origin, `range` for a miss; `ignored` is sorted.
    void scan(Vec3 origin, const std::vector<Vec3>& directions, double range, const std::vector<BodyId>& ignored,
              double* distances) const;
    WorldHit raycast(Vec3 origin, Vec3 direction, double max_distance, const std::vector<BodyId>& ignored) const;

    // All colliding pairs, lower id first, in no particular order; blocks of bodies can be processed in parallel.
    int32_t blocks() const;
    void contact_pairs_of_block(int32_t block, double margin, std::vector<std::pair<BodyId, BodyId>>& out) const;

    const Body& body(BodyId id) const;  // throws for an unknown id
    const Body* find(BodyId id) const;
    BodyId id_of(const std::string& name) const;  // -1: none
    int32_t end_id() const { return static_cast<int32_t>(bodies_.size()); }
    void set_end_id(BodyId id) { bodies_.resize(std::max<size_t>(bodies_.size(), id)); }
    size_t size() const { return names_.size(); }
    Masks masks() const { return masks_; }
    const char* masks_name() const {
        return masks_ == Masks::path ? "path" : masks_ == Masks::off ? "off" : "published";
    }
    const std::vector<std::string>& groups() const { return groups_; }
    const std::vector<std::pair<int32_t, int32_t>>& allowed_groups() const { return allowed_groups_; }
    bool ignores(const Body& a, const Body& b) const;  // pairs that are excluded from collision
    int64_t tests() const { return tests_; }
    int64_t motion_steps() const { return motion_steps_; }
    size_t nbytes() const;

    mutable FairMutex mutex;

private:
    class StopSchedule;
    struct PairContact {  // contact of two movers; fractions of the whole motion
        MotionContact contact;
        BodyPair pair;
        int64_t checks = 0;
    };
    struct Stretch {  // fractions of a motion
        double begin, end;
    };
    struct Fleet {
        std::vector<SweptMover> movers;               // empty for movers without bodies or movers nearby
        std::vector<std::vector<int32_t>> neighbors;  // per mover: movers with nearby motions, ascending
        std::vector<MotionOutcome> alone;             // per mover: first contact with itself or bodies of no mover
    };

    Body& at(BodyId id);
    Body& root_at(BodyId id, const char* what);
    int32_t group(const std::string& name);
    const Robot* robot_of(const Body& body) const { return bodies_[body.root]->robot.get(); }
    void refresh(Body& body, const Rigid& pose);
    void reindex(const std::vector<BodyId>& moved);
    void settle(BodyId id);
    void adopt(BodyId id, BodyId root, int32_t link, const Rigid& offset);
    void put(const std::vector<BodyId>& roots, const std::vector<Place>& places);
    void erase_body(BodyId id, std::vector<std::shared_ptr<Shape>>& shapes);
    void find_own_pairs(Body& robot);
    void bonds_changed(BodyId root);
    bool meets(const Path& path, BodyId robot, const Body& body) const;
    void update_masks(BodyId id);
    void update_all_masks();
    void find_movers(BodyId id, std::vector<BodyId>& out) const;
    void drop_legs(Path& path);
    std::vector<Box> legs_of(const Body& robot, const std::vector<Place>& places) const;
    void set_candidates(BodyId robot, std::vector<BodyId> candidates);
    void candidates(const Body& robot, const Box& box, std::vector<BodyId>& out) const;
    Rigid pose_of(const Body& body, double time) const;
    Box box_of(const Body& body, double time) const;
    Box rough_box(const Body& robot, const Place& from, const Place& to, double margin) const;
    PlacedMover placed(const Body& robot, const Place& place, double margin) const;
    SweptMover swept(const Body& robot, const Place& from, const Place& to, double margin) const;
    template <class Mover, class Visit>
    bool pairs_between(const Mover& a, int32_t index_a, const Mover& b, int32_t index_b, const Visit& visit) const;
    template <class Mover, class Skips, class BoxOf, class Visit>
    bool pairs_with_bodies(const Mover& mover, int32_t index, std::span<const BodyId> bodies, const Skips& skips,
                           PairOrder order, const BoxOf& box_of, const Visit& visit) const;
    template <class Mover, class BoxOf, class Visit>
    bool for_each_pair(std::span<const Mover> movers, const std::vector<BodyId>* bodies, PairOrder order,
                       const BoxOf& box_of, const Visit& visit) const;
    template <class Mover, class BoxOf>
    bool free_of_contact(std::span<const Mover> movers, const std::vector<BodyId>* bodies, PairOrder order,
                         const BoxOf& box_of, const InstantTest& test, BodyPair& pair, int64_t& checks) const;
    bool collides_at(const SweptMover& mover, double t, const std::vector<BodyId>& others, const MotionSettings& s,
                     MotionOutcome& out) const;
    MotionOutcome step_through(const SweptMover& mover, const std::vector<BodyId>& others,
                               const MotionSettings& s) const;
    void certify_along_trajectory(const SweptPart& part, const Body& other, const MotionSettings& s,
                                  MotionContact& contact) const;
    void certify(const CandidatePair<SweptPart>& pair, const SweptMover& mover, const MotionSettings& s,
                 MotionOutcome& out) const;
    void certify_all(const SweptMover& mover, const std::vector<BodyId>& others, const MotionSettings& s,
                     MotionOutcome& out) const;
    void certify_later(const SweptMover& mover, const std::vector<BodyId>& others, const MotionSettings& s,
                       MotionOutcome& out) const;
    Fleet fleet(const std::vector<BodyId>& robots, const std::vector<Place>& from, const std::vector<Place>& to,
                const MotionSettings& s) const;
    PairContact first_contact(const SweptMover& a, bool a_rests, const SweptMover& b, bool b_rests, Stretch stretch,
                              const MotionSettings& s) const;
    std::vector<MotionOutcome> first_contacts(const Fleet& fleet, const MotionSettings& s) const;
    void count_tests(const std::vector<MotionOutcome>& outcomes) const;
    bool collides_again(std::span<const PlacedMover> movers, double margin, const BodyPair& last,
                        int64_t& checks) const;
    bool stand_free(const std::vector<BodyId>& robots, const std::vector<Place>& places, double margin, BodyPair& last,
                    int64_t& checks) const;
    bool move_free(const std::vector<BodyId>& robots, const std::vector<Place>& from, const std::vector<Place>& to,
                   const MotionSettings& settings, BodyPair& last, int64_t& checks) const;
    bool free_at_sample(const std::vector<SweptMover>& movers, const std::vector<Place>& places,
                        const std::vector<CandidatePair<SweptPart>>& pairs, double margin, BodyPair& last,
                        int64_t& checks) const;
    bool certified_free(const std::vector<SweptMover>& movers, const std::vector<CandidatePair<SweptPart>>& pairs,
                        const MotionSettings& s, BodyPair& last, int64_t& checks) const;

    Masks masks_;
    std::vector<std::unique_ptr<Body>> bodies_;  // by id
    std::map<std::string, BodyId> names_;
    std::vector<std::string> groups_;
    std::vector<std::pair<int32_t, int32_t>> allowed_groups_;
    BoxIndex index_;              // extents of bodies
    BoxIndex legs_;               // motion boxes
    std::vector<BodyId> leg_of_;  // by item of legs_; -1 for a free item
    std::map<BodyId, Path> paths_;
    mutable std::atomic<int64_t> tests_{0}, motion_steps_{0};
};

}  // namespace fgenv
