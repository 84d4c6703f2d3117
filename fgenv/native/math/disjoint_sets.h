// Union-find with path halving.
#pragma once

#include <cstdint>
#include <numeric>
#include <vector>

namespace fgenv {

class DisjointSets {
public:
    explicit DisjointSets(size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }

    int32_t root(int32_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(int32_t a, int32_t b) { parent_[root(a)] = root(b); }

    // Numbers the sets from 0 in the order of their first members; returns how many there are.
    int32_t label(std::vector<int32_t>& labels) {
        std::vector<int32_t> number(parent_.size(), -1);
        labels.resize(parent_.size());
        int32_t n = 0;
        for (size_t i = 0; i < parent_.size(); ++i) {
            int32_t& id = number[root(static_cast<int32_t>(i))];
            if (id < 0) id = n++;
            labels[i] = id;
        }
        return n;
    }

private:
    std::vector<int32_t> parent_;
};

}  // namespace fgenv
