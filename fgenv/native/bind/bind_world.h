// Shared parts of the world's bindings: its lock, and arguments for bodies and places.
//
// Every call locks the world: shared for queries, exclusive for changes. A thread that waits for the lock
// releases the interpreter, so that the thread that holds the lock may call back into Python.
#pragma once

#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/vector.h>

#include <mutex>

#include "bind/arguments.h"
#include "bind/configurations.h"
#include "world/world.h"

namespace fgenv {

template <class Lock>
Lock locked(const World& w) {
    Lock lock(w.mutex, std::try_to_lock);
    if (!lock) {
        nb::gil_scoped_release released;
        lock.lock();
    }
    return lock;
}
static inline auto reading(const World& w) { return locked<std::shared_lock<FairMutex>>(w); }
static inline auto writing(const World& w) { return locked<std::unique_lock<FairMutex>>(w); }

[[noreturn]] static inline void fail(const std::string& text) { throw nb::value_error(text.c_str()); }

// An argument for a body, by id or by name. Read before the world is locked, since reading may run Python code.
struct Asked {
    bool by_name;
    BodyId id = -1;
    std::string words;  // the name, or the text of an invalid id

    std::string text() const { return by_name || id < 0 ? words : std::to_string(id); }
};
Asked asked(nb::handle value, const char* name);
BodyId body_of(const World& w, const Asked& asked, const char* name);
BodyId root_of(const World& w, BodyId id, const char* name);
BodyId robot_of(const World& w, const Asked& asked, const char* name = "robot");

// One id or name, or a sequence of them.
struct AskedBodies {
    std::vector<Asked> items;
    bool one;

    std::vector<BodyId> ids(const World& w, const char* name) const;
};
AskedBodies asked_bodies(nb::handle value, const char* name);

using Model = std::shared_ptr<const Robot>;  // null for a body that is not a robot

// An argument for places: poses (..., 4, 4) of a body, or configurations (..., nq) of a robot.
struct Places {
    Model model;
    Poses poses;
    Configurations configurations{{}, {}, 0};

    const Dims& dims() const { return model ? configurations.dims : poses.dims; }
    bool single() const { return dims().empty(); }
    Place operator[](int64_t i) const {
        if (!model) return {poses[i], {}};
        const double* q = configurations.row(i);
        return {identity(), {q, q + configurations.nq}};
    }
    std::vector<Place> all() const {
        std::vector<Place> out;
        for (int64_t i = 0; i < dims()[0]; ++i) out.push_back((*this)[i]);
        return out;
    }
    const char* row() const { return model ? ", nq)" : ", 4, 4)"; }
};

Places places(const Model& model, nb::handle value, const char* name);
// Model of the mover. Read before its places, which are checked without the lock.
Model model_of(const World& w, const Asked& asked, const char* name = "robot");
// The mover; raises if its model has changed since.
BodyId mover_of(const World& w, const Asked& asked, const Model& model, const char* name = "robot");

Rigid pose_of(nb::handle value, const char* name);
Array<double> times_of(nb::handle value, const char* name);  // finite seconds
Trajectory trajectory_of(const Model& model, nb::handle times, nb::handle poses);

nb::object id_array(const std::vector<BodyId>& ids);
nb::object pose_out(const std::vector<Rigid>& poses, const Dims& dims);
nb::object places_out(const std::vector<Place>& places, const Model& model);
// Bits of the movers with a motion box that the body overlaps, including its own.
nb::int_ mask_of(const World& w, const Body& body);

void bind_world_queries(nb::class_<World>& c);
void bind_world_motions(nb::class_<World>& c);
void bind_world_state(nb::class_<World>& c);

}  // namespace fgenv
