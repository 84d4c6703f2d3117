#include "world/checker.h"

#include <algorithm>

namespace fgenv {

Checker::Checker(const World& world, std::vector<Member> members, const MotionSettings& settings)
    : world_(world), members_(std::move(members)), settings_(settings), legs_(members_.size()) {
    settings_.certify.first = false;
    for (const Member& m : members_) {
        ids_.push_back(m.id);
        size_ += m.size;
        straight_ &= m.steering.method == SteeringMethod::straight;
    }
}

// The members must still be the same movers as at construction.
void Checker::ask() const {
    for (const Member& m : members_) {
        const Body* body = world_.find(m.id);
        if (!body || body->robot != m.model || body->root != m.id)
            throw std::invalid_argument(
                "robot: got body " + std::to_string(m.id) +
                ", removed, replaced or attached since construction, expected the same body; create a new checker");
    }
}

bool Checker::place(const double* state, std::vector<Place>& out) const {
    if (!std::all_of(state, state + size_, [](double x) { return std::isfinite(x) && std::fabs(x) < 1e12; }))
        return false;
    out.resize(members_.size());
    for (size_t i = 0; i < members_.size(); ++i) {
        const Member& m = members_[i];
        Place& at = out[i];
        if (m.level()) {
            double s, c;
            sin_cos(0.5 * state[3], s, c);
            at.q.assign({state[0], state[1], state[2], 0, 0, s, c});
            at.q.insert(at.q.end(), state + 4, state + m.size);
        } else if (m.model) {
            at.q.assign(state, state + m.size);
        } else if (m.size == 3) {
            double s, c;
            sin_cos(state[2], s, c);
            at.pose = {{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}, {state[0], state[1], world_.body(m.id).pose.t[2]}};
        } else {
            to_matrix(normalized({state[3], state[4], state[5], state[6]}), at.pose.r);
            std::copy_n(state, 3, at.pose.t);
        }
        state += m.size;
    }
    return true;
}

bool Checker::valid(const double* state) {
    ask();
    ++states;
    return place(state, to_) && world_.free_at(ids_, to_, settings_.certify.margin, last_pair_);
}

bool Checker::free(const double* from, const double* to) {
    ask();
    ++motions;
    if (!place(from, from_) || !place(to, to_)) return false;
    if (straight_) return world_.free_on(ids_, from_, to_, settings_, last_pair_);
    if (!world_.free_at(ids_, to_, settings_.certify.margin, last_pair_)) return false;
    for (size_t i = 0; i < members_.size(); ++i) {
        const Member& m = members_[i];
        if (!m.model) continue;
        legs(*m.model, m.steering, from_[i].q.data(), to_[i].q.data(), legs_[i]);
        if (m.steering.method == SteeringMethod::straight) continue;
        for (size_t row = 0; row < legs_[i].size(); row += m.model->nq())
            for (int axis = 0; axis < 2; ++axis)
                if (legs_[i][row + axis] < m.room[0][axis] || legs_[i][row + axis] > m.room[1][axis]) return false;
    }
    // Each member spends equal times on its legs. A leg is split only where a leg of another member ends.
    std::vector<double> ends;
    for (size_t i = 0; i < members_.size(); ++i) {
        const size_t n = members_[i].model ? legs_[i].size() / members_[i].model->nq() - 1 : 1;
        for (size_t k = 1; k <= n; ++k) ends.push_back(double(k) / double(n));
    }
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    std::vector<Place> first = from_, last = to_, next = from_;
    for (const double t : ends) {
        for (size_t i = 0; i < members_.size(); ++i) {
            const Member& m = members_[i];
            if (!m.model) {
                next[i] = between(nullptr, first[i], last[i], t);
                continue;
            }
            const size_t nq = m.model->nq(), n = legs_[i].size() / nq - 1;
            const size_t k = std::min(n - 1, static_cast<size_t>(t * double(n)));
            const double* row = legs_[i].data() + k * nq;
            interpolate(*m.model, row, row + nq, lesser(t * double(n) - double(k), 1), next[i].q.data());
        }
        if (!world_.free_on(ids_, from_, next, settings_, last_pair_)) return false;
        std::swap(from_, next);
    }
    return true;
}

double Checker::clearance(const double* state) {
    ask();
    ++states;
    if (!place(state, to_)) return 0;
    return world_.clearance(ids_, to_, now).distance;
}

}  // namespace fgenv
