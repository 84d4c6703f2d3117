// States as bytes: one `visit` of a struct serves both the writer and the reader.
#pragma once

#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace fgenv {

[[noreturn]] inline void damaged_state() { throw std::invalid_argument("state: damaged, or of another simulator"); }

class Writer {
public:
    template <class... T>
    void operator()(const T&... items) {
        (put(items), ...);
    }
    const std::string& bytes() const { return bytes_; }

private:
    template <class T>
    void put(const T& item) {
        static_assert(std::is_trivially_copyable_v<T>);
        bytes_.append(reinterpret_cast<const char*>(&item), sizeof(T));
    }
    template <class T>
    void put(const std::vector<T>& items) {
        put(static_cast<uint64_t>(items.size()));
        for (const T& item : items) put(item);
    }

    std::string bytes_;
};

class Reader {
public:
    explicit Reader(std::string bytes) : bytes_(std::move(bytes)) {}
    template <class... T>
    void operator()(T&... items) {
        (get(items), ...);
    }
    bool done() const { return at_ == bytes_.size(); }

private:
    template <class T>
    void get(T& item) {
        static_assert(std::is_trivially_copyable_v<T>);
        if (bytes_.size() - at_ < sizeof(T)) damaged_state();
        std::memcpy(&item, bytes_.data() + at_, sizeof(T));
        at_ += sizeof(T);
    }
    void get(bool& item) {
        uint8_t byte = 0;
        get(byte);
        if (byte > 1) damaged_state();
        item = byte;
    }
    template <class T>
    void get(std::vector<T>& items) {
        uint64_t n = 0;
        get(n);
        if (n > bytes_.size() - at_) damaged_state();  // an item takes at least one byte
        items.resize(n);
        for (T& item : items) get(item);
    }

    std::string bytes_;
    size_t at_ = 0;
};

}  // namespace fgenv
