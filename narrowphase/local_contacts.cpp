#include <grapeshot/narrowphase/local_contacts.hpp>

#include <algorithm>
#include <bit>
#include <cassert>
#include <utility>

#include <grapeshot/adb/lane_contact.hpp>
#include <grapeshot/core/detail/leaf_triangles.hpp>
#include <grapeshot/narrowphase/detail/contact_collector.hpp>
#include <grapeshot/narrowphase/detail/feature_contacts.hpp>
#include <grapeshot/narrowphase/detail/feature_filter.hpp>
#include <grapeshot/narrowphase/detail/leaf_filter.hpp>
#include <grapeshot/narrowphase/detail/placed_leaf.hpp>
#include <grapeshot/narrowphase/detail/point_contacts.hpp>

namespace grapeshot {

using detail::FeatureMasks;
using detail::PlacedTriangle;
using Eigen::Vector3f;

static float roundingOf(const MeshModel& a, const MeshModel& b, const Pose& bInA) {
    return detail::coordinateRounding(a.tree.radius + b.tree.radius + bInA.translation.norm());
}

struct LocalContactSearch::State {
    void test(const LeafPair& pair, bool facing, bool boxesOverlap);
    void addOverlapping(const LeafPair& pair);
    void testFeatures(const FeatureMasks& masks, const LeafPair& pair);

    const MeshModel* a = nullptr;
    const MeshModel* b = nullptr;
    Pose bInA;
    LocalContactSettings settings;
    detail::LeafFilter filter;
    detail::FeatureLimits limits;
    detail::MeshSide sideA, sideB;
    detail::LeafPlacer placerA, placerB;
    detail::ContactCollector collector;
    detail::FeatureContacts features;
    std::vector<TriangleContact> overlapping;
    std::uint64_t work = 0;
    std::uint32_t tested = 0;
};

static_assert(LocalContactSearch::fewPairs == detail::LeafFilter::width);

LocalContactSearch::LocalContactSearch() : m_state(std::make_unique<State>()) {}
LocalContactSearch::~LocalContactSearch() = default;

void LocalContactSearch::start(const MeshModel& a, const MeshModel& b, const Pose& bInA,
                               const LocalContactSettings& settings) {
    State& s = *m_state;
    s.a = &a;
    s.b = &b;
    s.bInA = bInA;
    s.settings = settings;
    s.filter = detail::LeafFilter(a, b, bInA, settings.lean, settings.maxDistance);
    const float rounding = roundingOf(a, b, bInA);
    s.limits = {settings.maxDistance, rounding, settings.lean, a.solid, b.solid, false, false};
    s.sideA = detail::MeshSide(a, nullptr);
    s.sideB = detail::MeshSide(b, &s.bInA);
    s.placerA.start(s.sideA, settings.lean);
    s.placerB.start(s.sideB, settings.lean);
    s.collector.clear();
    s.features = detail::FeatureContacts(s.sideA, s.sideB, rounding, settings, s.collector);
    s.overlapping.clear();
    s.work = 0;
    s.tested = 0;
}

std::size_t LocalContactSearch::add(std::span<const LeafPair> pairs, std::uint64_t mostWork) {
    const State& s = *m_state;
    const std::uint64_t limit = mostWork > unlimited - s.work ? unlimited : s.work + mostWork;
    for (std::size_t first = 0; first < pairs.size(); first += fewPairs) {
        const auto some = pairs.subspan(first, std::min(fewPairs, pairs.size() - first));
        std::uint32_t near = 0;
        if (const std::size_t done = addFew(some, limit - s.work, near); done < some.size()) {
            return first + done;
        }
    }
    return pairs.size();
}

std::size_t LocalContactSearch::addFew(std::span<const LeafPair> pairs, std::uint64_t mostWork, std::uint32_t& near) {
    State& s = *m_state;
    assert(s.a != nullptr && pairs.size() <= fewPairs);
    const std::uint64_t limit = mostWork > unlimited - s.work ? unlimited : s.work + mostWork;
    const detail::LeafMasks masks = s.filter(pairs);
    near = masks.within;
    for (std::uint32_t rest = masks.touching | masks.overlapping; rest != 0; rest &= rest - 1) {
        const auto i = static_cast<std::uint32_t>(std::countr_zero(rest));
        const bool boxesOverlap = (masks.overlapping >> i & 1U) != 0;
        if (limit - s.work < (boxesOverlap ? 3U : 1U)) {
            return i;
        }
        s.test(pairs[i], (masks.touching >> i & 1U) != 0, boxesOverlap);
    }
    return pairs.size();
}

void LocalContactSearch::State::test(const LeafPair& pair, bool facing, bool boxesOverlap) {
    ++work;
    ++tested;
    limits.contacts = facing;
    limits.overlaps = boxesOverlap;
    FeatureMasks masks;
    detail::filterFeatures(placerA.rows(pair.leafA), placerB.rows(pair.leafB), limits, masks);
    if (masks.overlapping != 0) {
        ++work;
        if (detail::overlapsLeaves(a->tree.leaves[pair.leafA].corner, b->tree.leaves[pair.leafB].corner, bInA) != 0) {
            ++work;
            addOverlapping(pair);
        }
    }
    if (masks.any != 0) {
        testFeatures(masks, pair);
    }
}

void LocalContactSearch::State::addOverlapping(const LeafPair& pair) {
    const LeafBlock& blockA = a->tree.leaves[pair.leafA];
    const LeafBlock& blockB = b->tree.leaves[pair.leafB];
    DistanceBatch batch;
    detail::signedDistancesLeaves(blockA.corner, blockB.corner, bInA, batch, 0);
    for (std::uint32_t rest = batch.overlapping; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<std::uint32_t>(std::countr_zero(rest));
        const TrianglePair triangles{blockA.triangle[lane >> 2U], blockB.triangle[lane & 3U]};
        if (triangles.triangleA != noTriangle && triangles.triangleB != noTriangle) {
            overlapping.push_back(laneContact(batch, lane, triangles));
        }
    }
}

void LocalContactSearch::State::testFeatures(const FeatureMasks& masks, const LeafPair& pair) {
    const auto& trianglesA = placerA.triangles(pair.leafA);
    const auto& trianglesB = placerB.triangles(pair.leafB);
    const auto each = [&](std::uint32_t mask, auto&& visit) {
        for (; mask != 0; mask &= mask - 1) {
            const auto lane = static_cast<std::uint32_t>(std::countr_zero(mask));
            visit(trianglesA[lane >> 2U], trianglesB[lane & 3U]);
        }
    };
    using Placed = const PlacedTriangle&;
    for (unsigned i = 0; i < 3; ++i) {
        each(masks.cornerBFaceA[i], [&](Placed ta, Placed tb) { features.cornerBFaceA(ta, tb, i); });
        each(masks.cornerAFaceB[i], [&](Placed ta, Placed tb) { features.cornerAFaceB(ta, i, tb); });
        for (unsigned j = 0; j < 3; ++j) {
            each(masks.edges[i][j], [&](Placed ta, Placed tb) { features.edges(ta, i, tb, j); });
            each(masks.cornerBEdgeA[i][j], [&](Placed ta, Placed tb) { features.cornerBEdgeA(ta, j, tb, i); });
            each(masks.cornerAEdgeB[i][j], [&](Placed ta, Placed tb) { features.cornerAEdgeB(ta, i, tb, j); });
            each(masks.corners[i][j], [&](Placed ta, Placed tb) { features.corners(ta, i, tb, j); });
        }
    }
}

void LocalContactSearch::finish(std::vector<SurfaceContact>& out) {
    State& s = *m_state;
    std::sort(s.overlapping.begin(), s.overlapping.end(),
              [](const TriangleContact& left, const TriangleContact& right) {
                  return std::pair(left.pair.triangleA, left.pair.triangleB) <
                         std::pair(right.pair.triangleA, right.pair.triangleB);
              });
    // A leaf pair may have come more than once.
    const auto same = [](const TriangleContact& left, const TriangleContact& right) { return left.pair == right.pair; };
    s.overlapping.erase(std::unique(s.overlapping.begin(), s.overlapping.end(), same), s.overlapping.end());
    s.collector.thinCorners();
    s.collector.finish(1e-4F * std::min(s.a->tree.radius, s.b->tree.radius), out);
}

std::uint64_t LocalContactSearch::work() const {
    return m_state->work;
}
std::uint32_t LocalContactSearch::tested() const {
    return m_state->tested;
}
std::span<const TriangleContact> LocalContactSearch::overlapping() const {
    return m_state->overlapping;
}

void localContactsExhaustive(const MeshModel& a, const MeshModel& b, const Pose& bInA,
                             std::span<const TrianglePair> pairs, const LocalContactSettings& settings,
                             std::vector<SurfaceContact>& out) {
    const detail::MeshSide sideA(a, nullptr);
    const detail::MeshSide sideB(b, &bInA);
    detail::ContactCollector collector;
    collector.clear();
    detail::FeatureContacts features(sideA, sideB, roundingOf(a, b, bInA), settings, collector);
    for (const TrianglePair& pair : pairs) {
        PlacedTriangle placedA;
        PlacedTriangle placedB;
        sideA.place(pair.triangleA, placedA);
        sideB.place(pair.triangleB, placedB);
        features.everything(placedA, placedB);
    }
    collector.thinCorners();
    collector.finish(1e-4F * std::min(a.tree.radius, b.tree.radius), out);
}

}  // namespace grapeshot
