// Depth-first descent of the trees of two shapes, and of the tree of one. A policy decides what is pruned, in
// which order children are taken, what happens at the leaves, and when to stop.
//
// Both kinds of policy have `order`, the type Children (Unordered, Ordered or one with more), and
//     bool stop()               asked before each step
//     bool prune(entry)         whether an entry of the stack matters no more
//     Children open(...)        the children of a node that may matter
// A policy of two trees has `from_a` and `from_b`, the other shape as seen from a and from b, and
//     Pair pair(a, b, children, lane)   entry of the stack
//     bool prune(box_a, box_b)          whether an inner node against a leaf needs no opening
//     void leaves(box_a, box_b)
// A policy of one tree has
//     Entry entry(child, children, lane)
//     void leaf(leaf)
#pragma once

#include "query/box_culling.h"

namespace fgenv {

// Order in which the children of a node are taken.
enum class Order { any, least_key_first, rising_keys };

// The children of a node that may matter, one bit per lane.
struct Unordered {
    uint32_t mask;
};
struct Ordered {
    uint32_t mask;
    F8 key;
};

// Pushes entry(lane) for each child; the child to be taken first ends on top. Returns the new top.
template <Order order, class Entry, class Children, class MakeEntry>
FGENV_INLINE int push_children(Entry* stack, int top, const Children& children, const MakeEntry& entry) {
    const int first = top;
    float keys[lanes], least = HUGE_VALF;
    for (uint32_t m = children.mask; m; m &= m - 1) {
        const int lane = __builtin_ctz(m);
        int at = top++;
        if constexpr (order == Order::rising_keys) {
            const float key = children.key[lane];
            for (; at > first && keys[at - 1 - first] < key; --at) {
                keys[at - first] = keys[at - 1 - first];
                stack[at] = stack[at - 1];
            }
            keys[at - first] = key;
        }
        if constexpr (order == Order::least_key_first) {
            if (children.key[lane] < least)
                least = children.key[lane];
            else {
                stack[at] = stack[at - 1];
                --at;
            }
        }
        stack[at] = entry(lane);
    }
    return top;
}

template <class Policy>
FGENV_INLINE void descend(const Tree& tree_a, const Tree& tree_b, Policy& policy) {
    const OrientedBox *boxes_a = tree_a.boxes.data(), *boxes_b = tree_b.boxes.data();
    typename Policy::Pair stack[2 * max_depth * (lanes - 1) + lanes];
    int top = 0;
    stack[top++] = policy.pair(0, 0, typename Policy::Children{}, 0);
    while (top && !policy.stop()) {
        const auto pair = stack[--top];
        if (policy.prune(pair)) continue;
        const OrientedBox &a = boxes_a[pair.a], &b = boxes_b[pair.b];
        if (a.child < 0 && b.child < 0) {
            policy.leaves(a, b);
            continue;
        }
        if (policy.prune(a, b)) continue;
        const bool opens_a = b.child < 0 || (a.child >= 0 && size(a) >= size(b));
        const typename Policy::Children next = opens_a ? policy.open(tree_a.oriented[a.child], b, policy.from_a)
                                                       : policy.open(tree_b.oriented[b.child], a, policy.from_b);
        const Ref first = static_cast<Ref>(lanes * (opens_a ? a.child : b.child));
        top = push_children<Policy::order>(stack, top, next, [&](int lane) {
            const Ref child = first + static_cast<Ref>(lane);
            if constexpr (Policy::order == Order::least_key_first)
                __builtin_prefetch(opens_a ? &boxes_a[child] : &boxes_b[child]);
            return opens_a ? policy.pair(child, pair.b, next, lane) : policy.pair(pair.a, child, next, lane);
        });
    }
}

template <class Policy>
FGENV_INLINE void descend(const Tree& tree, Policy& policy) {
    typename Policy::Entry stack[max_depth * (lanes - 1) + lanes];
    int top = 0;
    stack[top++] = policy.entry(tree.nodes[0].child[0], typename Policy::Children{}, 0);
    while (top && !policy.stop()) {
        const auto entry = stack[--top];
        if (policy.prune(entry)) continue;
        if (entry.child < 0) {
            policy.leaf(tree.leaves[~entry.child]);
            continue;
        }
        const Node& node = tree.nodes[entry.child];
        const typename Policy::Children next = policy.open(node);
        top = push_children<Policy::order>(stack, top, next,
                                           [&](int lane) { return policy.entry(node.child[lane], next, lane); });
    }
}

}  // namespace fgenv
