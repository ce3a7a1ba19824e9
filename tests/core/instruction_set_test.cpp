#include <grapeshot/core/instruction_set.hpp>

#include <gtest/gtest.h>

#include <algorithm>

namespace grapeshot {
namespace {

TEST(InstructionSet, LimitIsNeverExceededAndCanBeLifted) {
    const InstructionSet best = limitInstructionSet(InstructionSet::avx512);
    EXPECT_EQ(instructionSet(), best);
    for (const InstructionSet wish : {InstructionSet::scalar, InstructionSet::avx2, InstructionSet::avx512}) {
        const InstructionSet got = limitInstructionSet(wish);
        EXPECT_EQ(got, instructionSet());
        EXPECT_EQ(got, std::min(wish, best));
    }
    EXPECT_EQ(limitInstructionSet(InstructionSet::scalar), InstructionSet::scalar);
    EXPECT_EQ(limitInstructionSet(InstructionSet::avx512), best);
}

TEST(InstructionSet, Names) {
    EXPECT_EQ(name(InstructionSet::scalar), "scalar");
    EXPECT_EQ(name(InstructionSet::avx2), "avx2");
    EXPECT_EQ(name(InstructionSet::avx512), "avx512");
}

}  // namespace
}  // namespace grapeshot
