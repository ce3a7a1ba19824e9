#include <grapeshot/core/error.hpp>

#include <gtest/gtest.h>

#include <set>

namespace grapeshot {
namespace {

TEST(Error, SaysFaultDetailAndPlace) {
    const Error error(Fault::notFinite, "(nan, 0, 0)", "vertex 17");
    EXPECT_EQ(error.fault(), Fault::notFinite);
    EXPECT_EQ(error.place(), "vertex 17");
    EXPECT_STREQ(error.what(), "notFinite: (nan, 0, 0) (vertex 17)");
}

TEST(Error, FaultsHaveDistinctNames) {
    std::set<std::string_view> names;
    for (int i = 0; i <= static_cast<int>(Fault::limitExceeded); ++i) {
        names.insert(name(static_cast<Fault>(i)));
    }
    EXPECT_EQ(names.size(), static_cast<std::size_t>(Fault::limitExceeded) + 1);
    EXPECT_FALSE(names.contains("unknownFault"));
}

}  // namespace
}  // namespace grapeshot
