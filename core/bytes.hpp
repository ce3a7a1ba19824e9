// Numbers into bytes and back, for state that is saved.
//
// As they are in memory, one after the other without padding: for machines of the same byte order, which is all that
// this library runs on.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <grapeshot/core/error.hpp>

namespace grapeshot {

/// Appends to a vector.
class ByteWriter {
  public:
    explicit ByteWriter(std::vector<std::byte>& out) : m_out(out) {}

    template <class Number>
    requires(std::is_arithmetic_v<Number> || std::is_enum_v<Number>) void put(Number number) {
        const std::size_t at = m_out.size();
        m_out.resize(at + sizeof number);
        std::memcpy(m_out.data() + at, &number, sizeof number);
    }
    void put(const Eigen::Vector3f& v) {
        for (const float x : {v.x(), v.y(), v.z()}) {
            put(x);
        }
    }
    void put(const Eigen::Matrix3f& m) {
        for (int row = 0; row < 3; ++row) {
            put(Eigen::Vector3f(m.row(row).transpose()));
        }
    }
    void put(std::span<const std::byte> bytes) { m_out.insert(m_out.end(), bytes.begin(), bytes.end()); }

    [[nodiscard]] std::size_t size() const { return m_out.size(); }

  private:
    std::vector<std::byte>& m_out;
};

/// Reads what a ByteWriter wrote, and never beyond the end. Every `get` throws Error badFile if the bytes end before.
class ByteReader {
  public:
    /// @param place for errors
    explicit ByteReader(std::span<const std::byte> bytes, std::string place = "saved state")
        : m_bytes(bytes), m_place(std::move(place)) {}

    template <class Number>
    [[nodiscard]] Number get() {
        static_assert(std::is_arithmetic_v<Number>);
        static_assert(!std::is_same_v<Number, bool>, "a byte that is neither 0 nor 1 is no bool: see flag");
        Number number;
        std::memcpy(&number, take(sizeof number).data(), sizeof number);
        return number;
    }
    [[nodiscard]] bool flag() {
        const auto byte = get<std::uint8_t>();
        require(byte <= 1, "a flag of " + std::to_string(byte));
        return byte == 1;
    }
    [[nodiscard]] Eigen::Vector3f vector() {
        Eigen::Vector3f v;
        for (int i = 0; i < 3; ++i) {
            v[i] = get<float>();
        }
        return v;
    }
    [[nodiscard]] Eigen::Matrix3f matrix() {
        Eigen::Matrix3f m;
        for (int row = 0; row < 3; ++row) {
            m.row(row) = vector().transpose();
        }
        return m;
    }
    /// A 64-bit count of things that take at least so many bytes each: so many must still be there.
    [[nodiscard]] std::size_t count(std::size_t bytesEach) {
        const auto number = get<std::uint64_t>();
        require(number <= left() / bytesEach, "a count of " + std::to_string(number));
        return static_cast<std::size_t>(number);
    }
    [[nodiscard]] std::span<const std::byte> take(std::size_t size) {
        require(size <= left(), "it ends");
        const std::span<const std::byte> taken = m_bytes.subspan(m_at, size);
        m_at += size;
        return taken;
    }
    [[nodiscard]] std::size_t left() const { return m_bytes.size() - m_at; }
    void require(bool holds, const std::string& what) const {
        if (!holds) {
            throw Error(Fault::badFile, what + " at byte " + std::to_string(m_at), m_place);
        }
    }

  private:
    std::span<const std::byte> m_bytes;
    std::size_t m_at = 0;
    std::string m_place;
};

}  // namespace grapeshot
