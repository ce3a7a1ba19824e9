#include <grapeshot/core/bytes.hpp>

#include <gtest/gtest.h>

namespace grapeshot {
namespace {

TEST(Bytes, WhatIsPutIsGot) {
    std::vector<std::byte> bytes;
    ByteWriter out(bytes);
    Eigen::Matrix3f matrix;
    matrix << 1, 2, 3, 4, 5, 6, 7, 8, 9;
    const std::array raw{std::byte{1}, std::byte{2}};
    out.put(std::uint8_t{1});
    out.put(-7);
    out.put(0.1);
    out.put(Eigen::Vector3f(1, -2, 3));
    out.put(matrix);
    out.put(std::uint64_t{2});
    out.put(std::span<const std::byte>(raw));
    EXPECT_EQ(out.size(), 1U + 4 + 8 + 12 + 36 + 8 + 2);
    ByteReader in(bytes);
    EXPECT_TRUE(in.flag());
    EXPECT_EQ(in.get<int>(), -7);
    EXPECT_EQ(in.get<double>(), 0.1);
    EXPECT_EQ(in.vector(), Eigen::Vector3f(1, -2, 3));
    EXPECT_EQ(in.matrix(), matrix);
    ASSERT_EQ(in.count(1), 2U);
    const std::span<const std::byte> taken = in.take(2);
    EXPECT_EQ(taken[1], std::byte{2});
    EXPECT_EQ(in.left(), 0U);
}

Fault faultOf(void (*read)(ByteReader&)) {
    const std::array<std::byte, 9> bytes{std::byte{9}};
    ByteReader in(bytes, "here");
    try {
        read(in);
    } catch (const Error& error) {
        EXPECT_EQ(error.place(), "here");
        return error.fault();
    }
    return Fault::limitExceeded;
}

TEST(Bytes, NothingIsReadBeyondTheEnd) {
    EXPECT_EQ(faultOf([](ByteReader& in) { static_cast<void>(in.vector()); }), Fault::badFile);
    EXPECT_EQ(faultOf([](ByteReader& in) { static_cast<void>(in.take(10)); }), Fault::badFile);
    EXPECT_EQ(faultOf([](ByteReader& in) {
                  static_cast<void>(in.get<double>());
                  static_cast<void>(in.get<std::uint16_t>());
              }),
              Fault::badFile);
}

TEST(Bytes, CountsAndFlagsAreChecked) {
    EXPECT_EQ(faultOf([](ByteReader& in) { static_cast<void>(in.count(1)); }), Fault::badFile);  // nine of one left
    EXPECT_EQ(faultOf([](ByteReader& in) { static_cast<void>(in.flag()); }), Fault::badFile);
}

}  // namespace
}  // namespace grapeshot
