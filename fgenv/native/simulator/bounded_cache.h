// A cache of values that are expensive to compute, shared by threads.
#pragma once

#include <map>
#include <memory>
#include <mutex>

namespace fgenv {

// Forgets all values when `capacity` is reached; values in use live on.
template <class Key, class Value>
class BoundedCache {
public:
    explicit BoundedCache(size_t capacity) : capacity_(capacity) {}

    // The value of a key, computed once by `compute`; other threads that need it wait.
    template <class F>
    std::shared_ptr<const Value> get(const Key& key, F compute) {
        const std::shared_ptr<Entry> entry = entry_of(key);
        {
            const std::lock_guard lock(entry->mutex);
            if (!entry->value) entry->value = std::make_shared<const Value>(compute());
        }
        return entry->value;
    }

private:
    struct Entry {
        std::mutex mutex;
        std::shared_ptr<const Value> value;
    };

    std::shared_ptr<Entry> entry_of(const Key& key) {
        const std::lock_guard lock(mutex_);
        const auto known = entries_.find(key);
        if (known != entries_.end()) return known->second;
        if (entries_.size() >= capacity_) entries_.clear();
        return entries_[key] = std::make_shared<Entry>();
    }

    const size_t capacity_;
    std::mutex mutex_;
    std::map<Key, std::shared_ptr<Entry>> entries_;
};

}  // namespace fgenv
