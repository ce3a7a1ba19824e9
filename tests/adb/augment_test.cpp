// Trees over hierarchies that somebody else built: sound, with the same splits, and with the answers of our own trees.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <numeric>
#include <set>

#include <grapeshot/adb/augment.hpp>
#include <grapeshot/adb/detail/tree_contents.hpp>
#include <grapeshot/adb/query.hpp>
#include <grapeshot/core/error.hpp>
#include <support/poses.hpp>
#include <support/test_size.hpp>

#include "meshes.hpp"
#include "trees.hpp"

namespace grapeshot::test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Where a range of triangles is split, having put them into the order that it should have.
using Splitter = std::function<std::size_t(std::span<std::uint32_t>)>;

/// Split until at most `leafTriangles` are left.
ForeignHierarchy hierarchyBy(std::size_t triangles, std::size_t leafTriangles, const Splitter& split) {
    ForeignHierarchy out;
    out.triangles.resize(triangles);
    std::iota(out.triangles.begin(), out.triangles.end(), 0U);
    out.nodes.push_back({0, 0, 0, static_cast<std::uint32_t>(triangles)});
    for (std::size_t i = 0; i < out.nodes.size(); ++i) {
        const ForeignNode node = out.nodes[i];
        if (node.end - node.begin <= leafTriangles) {
            continue;
        }
        const std::span<std::uint32_t> range(out.triangles.data() + node.begin, node.end - node.begin);
        const std::uint32_t middle = node.begin + static_cast<std::uint32_t>(split(range));
        const auto left = static_cast<std::uint32_t>(out.nodes.size());
        out.nodes[i] = {left, left + 1, 0, 0};
        out.nodes.push_back({0, 0, node.begin, middle});
        out.nodes.push_back({0, 0, middle, node.end});
    }
    return out;
}

/// Halves by rank along the longest axis.
Splitter halves(const scenes::Mesh& mesh) {
    return [&mesh](std::span<std::uint32_t> range) {
        const auto middleOf = [&mesh](std::uint32_t triangle) {
            const Triangle& corners = mesh.triangles[triangle];
            return Eigen::Vector3f(mesh.vertices[corners[0]] + mesh.vertices[corners[1]] + mesh.vertices[corners[2]]);
        };
        Eigen::Vector3f lower = middleOf(range.front());
        Eigen::Vector3f upper = lower;
        for (const std::uint32_t triangle : range) {
            lower = lower.cwiseMin(middleOf(triangle));
            upper = upper.cwiseMax(middleOf(triangle));
        }
        Eigen::Index axis = 0;
        (upper - lower).maxCoeff(&axis);
        std::sort(range.begin(), range.end(), [&](std::uint32_t a, std::uint32_t b) {
            return std::pair(middleOf(a)[axis], a) < std::pair(middleOf(b)[axis], b);
        });
        return range.size() / 2;
    };
}

/// One triangle on the left, all others on the right.
std::size_t oneByOne(std::span<std::uint32_t> /*range*/) {
    return 1;
}

/// Anywhere, in the order of the index array.
Splitter anywhere(std::uint64_t seed) {
    return [random = Random(seed)](std::span<std::uint32_t> range) mutable {
        return 1 + static_cast<std::size_t>(random.bits() % (range.size() - 1));
    };
}

struct NamedHierarchy {
    const char* name;
    ForeignHierarchy hierarchy;
};
std::vector<NamedHierarchy> everyHierarchy(const scenes::Mesh& mesh) {
    const std::size_t count = mesh.triangles.size();
    return {{"balanced", hierarchyBy(count, 1, halves(mesh))},
            {"balanced, leaves of four", hierarchyBy(count, 4, halves(mesh))},
            {"large leaves", hierarchyBy(count, 50, halves(mesh))},
            {"chain", hierarchyBy(count, 1, &oneByOne)},
            {"random", hierarchyBy(count, 1, anywhere(7))},
            {"random, leaves of seven", hierarchyBy(count, 7, anywhere(8))},
            {"one leaf", hierarchyBy(count, count, &oneByOne)}};
}

bool sameTree(const Tree& a, const Tree& b) {
    return sameBytes(a.nodes, b.nodes) && sameBytes(a.distributions, b.distributions) && sameBytes(a.leaves, b.leaves);
}

TEST(Augment, IsSoundOnEveryKind) {
    for (const NamedMesh& kind : everyKind()) {
        for (const NamedHierarchy& foreign : everyHierarchy(kind.mesh)) {
            SCOPED_TRACE(kind.name + ", " + foreign.name);
            const Tree tree = augment(kind.mesh.view(), foreign.hierarchy);
            EXPECT_THAT(findings(tree), IsEmpty());
            EXPECT_EQ(tree.triangles.size(), kind.mesh.triangles.size());
        }
    }
}

using Group = std::vector<std::uint32_t>;  // triangles, ascending

/// Of a hierarchy whose children stand after their parents.
std::set<Group> groupsOf(const ForeignHierarchy& hierarchy) {
    std::vector<Group> groups(hierarchy.nodes.size());
    for (std::size_t i = groups.size(); i-- > 0;) {
        const ForeignNode& node = hierarchy.nodes[i];
        if (node.left == 0) {
            groups[i].assign(hierarchy.triangles.begin() + node.begin, hierarchy.triangles.begin() + node.end);
            std::sort(groups[i].begin(), groups[i].end());
        } else {
            std::merge(groups[node.left].begin(), groups[node.left].end(), groups[node.right].begin(),
                       groups[node.right].end(), std::back_inserter(groups[i]));
        }
    }
    return {groups.begin(), groups.end()};
}

std::vector<Group> groupsOf(const Tree& tree) {
    std::vector<Group> groups;
    const auto add = [&](detail::LeafRange range) {
        Group& group = groups.emplace_back();
        for (std::uint32_t leaf = range.begin; leaf < range.end; ++leaf) {
            const auto& lanes = tree.leaves[leaf].triangle;
            std::copy_if(lanes, lanes + 4, std::back_inserter(group), [](auto lane) { return lane != noTriangle; });
        }
        std::sort(group.begin(), group.end());
    };
    for (const detail::LeafRange range : detail::leafRanges(tree)) {
        add(range);
    }
    for (std::uint32_t leaf = 0; leaf < tree.leaves.size(); ++leaf) {
        add({leaf, leaf + 1});
    }
    return groups;
}

TEST(Augment, EveryNodeIsOneOfTheHierarchy) {
    for (const NamedMesh& kind : everyKind()) {
        for (const NamedHierarchy& foreign : everyHierarchy(kind.mesh)) {
            const std::string_view name = foreign.name;
            if (name != "balanced" && name != "balanced, leaves of four" && name != "random") {
                continue;  // split further
            }
            SCOPED_TRACE(kind.name + ", " + foreign.name);
            const std::set<Group> theirs = groupsOf(foreign.hierarchy);
            std::size_t unknown = 0;
            for (const Group& group : groupsOf(augment(kind.mesh.view(), foreign.hierarchy))) {
                unknown += theirs.contains(group) ? 0 : 1;
            }
            EXPECT_EQ(unknown, 0U);
        }
    }
}

TEST(Augment, LargeLeavesAreSplitWithinThemselves) {
    const scenes::Mesh mesh = scenes::bumpySphere(1, 0.25F, 6, 8);
    const ForeignHierarchy foreign = hierarchyBy(mesh.triangles.size(), 50, halves(mesh));
    std::vector<std::size_t> leafOf(mesh.triangles.size());
    for (std::size_t i = 0; i < foreign.nodes.size(); ++i) {
        for (std::uint32_t k = foreign.nodes[i].begin; k < foreign.nodes[i].end; ++k) {
            leafOf[foreign.triangles[k]] = i;
        }
    }
    const Tree tree = augment(mesh.view(), foreign);
    for (const LeafBlock& leaf : tree.leaves) {
        for (int lane = 1; lane < 4 && leaf.triangle[lane] != noTriangle; ++lane) {
            EXPECT_EQ(leafOf[leaf.triangle[lane]], leafOf[leaf.triangle[0]]);
        }
    }
}

TEST(Augment, OneLeafGivesTheTreeThatIsBuilt) {
    for (const NamedMesh& kind : everyKind()) {
        const std::size_t count = kind.mesh.triangles.size();
        EXPECT_TRUE(sameTree(augment(kind.mesh.view(), hierarchyBy(count, count, &oneByOne)), build(kind.mesh.view())))
            << kind.name;
    }
}

TEST(Augment, OneTriangle) {
    const Tree tree = augment(copiesOfOne(1).view(), {{{0, 0, 0, 1}}, {0}});
    EXPECT_THAT(findings(tree), IsEmpty());
    EXPECT_EQ(tree.nodes.size(), 1U);
    EXPECT_EQ(tree.leaves.size(), 1U);
}

TEST(Augment, SameBytesTwiceAndWhateverTheOrderOfTheNodes) {
    const scenes::Mesh mesh = scenes::bumpySphere(1, 0.25F, 6, 8);
    for (const NamedHierarchy& foreign : everyHierarchy(mesh)) {
        SCOPED_TRACE(foreign.name);
        const Tree tree = augment(mesh.view(), foreign.hierarchy);
        EXPECT_TRUE(sameTree(tree, augment(mesh.view(), foreign.hierarchy)));
        // The root stays where it is, all others are turned round; with spare nodes and triangles between them.
        const auto count = static_cast<std::uint32_t>(foreign.hierarchy.nodes.size());
        const auto moved = [count](std::uint32_t node) { return node == 0 ? 0 : 2 * (count - node); };
        ForeignHierarchy shuffled;
        shuffled.nodes.assign(std::size_t{2} * count + 1, {5, 5, 1, 0});
        shuffled.triangles.assign(3, 0xffffffffU);
        for (std::uint32_t i = 0; i < count; ++i) {
            const ForeignNode& node = foreign.hierarchy.nodes[i];
            shuffled.nodes[moved(i)] = {moved(node.left), moved(node.right), node.begin + 3, node.end + 3};
        }
        shuffled.triangles.insert(shuffled.triangles.end(), foreign.hierarchy.triangles.begin(),
                                  foreign.hierarchy.triangles.end());
        EXPECT_TRUE(sameTree(tree, augment(mesh.view(), shuffled)));
    }
}

TEST(Augment, ALongChainIsNoDeeperThanOtherTrees) {
    constexpr int count = 100'000;
    for (const scenes::Mesh& mesh : {soup(count, 0.01F, 3), copiesOfOne(count)}) {
        for (const bool mirrored : {false, true}) {
            ForeignHierarchy chain = hierarchyBy(count, 1, &oneByOne);
            for (ForeignNode& node : chain.nodes) {
                if (mirrored) {
                    std::swap(node.left, node.right);
                }
            }
            const Tree tree = augment(mesh.view(), chain);
            EXPECT_LE(depthOf(tree), 92U);
            if (mirrored && mesh.vertices.size() > 3) {
                EXPECT_THAT(findings(tree), IsEmpty());  // takes long
            }
        }
    }
}

TEST(Augment, RefitGoesOn) {
    scenes::Mesh mesh = scenes::bumpySphere(1, 0.25F, 6, 6);
    const ForeignHierarchy foreign = hierarchyBy(mesh.triangles.size(), 1, halves(mesh));
    Tree tree = augment(mesh.view(), foreign);
    for (Eigen::Vector3f& vertex : mesh.vertices) {
        vertex.y() *= 0.7F;
    }
    refit(tree, mesh.vertices);
    EXPECT_THAT(findings(tree), IsEmpty());
    EXPECT_EQ(tree.nodes.size(), augment(mesh.view(), foreign).nodes.size());
}

TEST(Augment, AnswersAreThoseOfOwnTrees) {
    const scenes::Mesh bumpy = scenes::normalised(scenes::bumpySphere(1, 0.25F, 6, 8));
    const scenes::Mesh knot = scenes::normalised(scenes::torusKnot(2, 3, 1, 0.5F, 0.2F, 60, 8));
    const Tree ownBumpy = build(bumpy.view());
    const Tree ownKnot = build(knot.view());
    const std::vector<Pose> poses =
        zachmannPoses(ownBumpy, ownKnot, 8, static_cast<int>(sampleSize(12, 300)), 17).poses;
    const std::vector<NamedHierarchy> ofBumpy = everyHierarchy(bumpy);
    const std::vector<NamedHierarchy> ofKnot = everyHierarchy(knot);
    for (std::size_t i = 0; i < ofBumpy.size(); ++i) {
        SCOPED_TRACE(ofBumpy[i].name);
        const Tree a = augment(bumpy.view(), ofBumpy[i].hierarchy);
        const Tree b = augment(knot.view(), ofKnot[i].hierarchy);
        Query own(ownBumpy, ownKnot);
        Query augmented(a, b);
        std::size_t colliding = 0;
        std::uint64_t ownWork = 0;
        std::uint64_t work = 0;
        for (const Pose& pose : poses) {
            const Decision expected = own.decide(pose, DecideSettings::exact());
            const Decision decision = augmented.decide(pose, DecideSettings::exact());
            ASSERT_EQ(decision.collides, expected.collides);
            ASSERT_TRUE(decision.certain);
            colliding += expected.collides ? 1 : 0;
            ownWork += expected.work;
            work += decision.work;
        }
        EXPECT_GT(colliding, poses.size() / 5);
        EXPECT_LT(colliding, poses.size() * 4 / 5);
        std::string key = ofBumpy[i].name;
        std::erase_if(key, [](char letter) { return letter == ' ' || letter == ','; });
        RecordProperty(key + "WorkPercent", static_cast<int>(100 * work / ownWork));
    }
}

TEST(Augment, NamesTheFault) {
    const scenes::Mesh mesh = scenes::sphere(1, 2);
    const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
    const ForeignHierarchy good = hierarchyBy(count, 1, halves(mesh));
    const auto leaf = static_cast<std::uint32_t>(
        std::find_if(good.nodes.begin(), good.nodes.end(), [](const auto& node) { return node.left == 0; }) -
        good.nodes.begin());
    const auto expectFault = [&](Fault fault, const std::string& words, const auto& damage) {
        ForeignHierarchy bad = good;
        damage(bad);
        try {
            (void)augment(mesh.view(), bad);
            ADD_FAILURE() << "no error: " << words;
        } catch (const Error& error) {
            EXPECT_EQ(error.fault(), fault) << error.what();
            EXPECT_THAT(error.what(), HasSubstr(words));
        }
    };
    expectFault(Fault::badHierarchy, "no nodes", [](auto& bad) { bad = {}; });
    expectFault(Fault::indexOutOfRange, "node 100000 of " + std::to_string(good.nodes.size()),
                [](auto& bad) { bad.nodes[2].right = 100000; });
    expectFault(Fault::indexOutOfRange, "(node 2 of the hierarchy)",
                [](auto& bad) { bad.nodes[2].left = 0xffffffffU; });
    // Cycles: to a node itself, to the root, to an ancestor; and a node under two others.
    expectFault(Fault::badHierarchy, "node 2 is reached a second time", [](auto& bad) { bad.nodes[2].right = 2; });
    expectFault(Fault::badHierarchy, "node 0 is reached a second time", [](auto& bad) { bad.nodes[2].right = 0; });
    expectFault(Fault::badHierarchy, "node 0 is reached a second time", [](auto& bad) { bad.nodes[0] = {1, 0, 0, 0}; });
    expectFault(Fault::badHierarchy, "node 1 is reached a second time",
                [](auto& bad) { bad.nodes[bad.nodes[1].left].left = 1; });
    expectFault(Fault::badHierarchy, "is reached a second time",
                [](auto& bad) { bad.nodes[1].left = bad.nodes[2].left; });
    expectFault(Fault::badHierarchy, "a leaf without triangles",
                [&](auto& bad) { bad.nodes[leaf].end = bad.nodes[leaf].begin; });
    expectFault(Fault::indexOutOfRange, "of " + std::to_string(count),
                [&](auto& bad) { bad.nodes[leaf].end = 100000; });
    expectFault(Fault::indexOutOfRange, "range 3 to 2", [&](auto& bad) { bad.nodes[leaf] = {0, 0, 3, 2}; });
    expectFault(Fault::indexOutOfRange, "triangle 5000 of " + std::to_string(count),
                [](auto& bad) { bad.triangles[7] = 5000; });
    expectFault(Fault::badHierarchy, "is met a second time", [](auto& bad) { bad.triangles[7] = bad.triangles[8]; });
    expectFault(Fault::badHierarchy, "triangle 0 is in no leaf", [](auto& bad) { bad = {{{0, 0, 0, 3}}, {3, 2, 1}}; });
    // What is wrong with the mesh comes first.
    scenes::Mesh nothing;
    EXPECT_THROW((void)augment(nothing.view(), good), Error);
}

}  // namespace
}  // namespace grapeshot::test
