// Sets as sorted vectors.
#pragma once

#include <algorithm>
#include <vector>

namespace fgenv {

template <class T>
bool contains(const std::vector<T>& sorted, const T& x) {
    return std::binary_search(sorted.begin(), sorted.end(), x);
}
template <class T>
void insert(std::vector<T>& sorted, const T& x) {
    const auto at = std::lower_bound(sorted.begin(), sorted.end(), x);
    if (at == sorted.end() || *at != x) sorted.insert(at, x);
}
template <class T>
void erase(std::vector<T>& sorted, const T& x) {
    const auto at = std::lower_bound(sorted.begin(), sorted.end(), x);
    if (at != sorted.end() && *at == x) sorted.erase(at);
}

}  // namespace fgenv
