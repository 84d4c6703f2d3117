// A shared mutex without starvation: readers that arrive while a writer waits queue behind it.
#pragma once

#include <mutex>
#include <shared_mutex>

namespace fgenv {

class FairMutex {
public:
    void lock() {
        const std::lock_guard<std::mutex> turn(door_);
        inside_.lock();
    }
    void lock_shared() {
        const std::lock_guard<std::mutex> turn(door_);
        inside_.lock_shared();
    }
    bool try_lock() {
        const std::unique_lock<std::mutex> turn(door_, std::try_to_lock);
        return turn && inside_.try_lock();
    }
    bool try_lock_shared() {
        const std::unique_lock<std::mutex> turn(door_, std::try_to_lock);
        return turn && inside_.try_lock_shared();
    }
    void unlock() { inside_.unlock(); }
    void unlock_shared() { inside_.unlock_shared(); }

private:
    std::mutex door_;  // held while waiting for `inside_`
    std::shared_mutex inside_;
};

}  // namespace fgenv
