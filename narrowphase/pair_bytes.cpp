#include <grapeshot/narrowphase/pair_bytes.hpp>

#include <cmath>
#include <string>

namespace grapeshot {
namespace {

constexpr std::uint64_t mostSlots = 4096;  // beyond any ContactSetSettings::maxRegions

void save(const Pose& pose, ByteWriter& out) {
    out.put(pose.rotation);
    out.put(pose.translation);
}

Pose loadPose(ByteReader& in) {
    Pose pose;
    pose.rotation = in.matrix();
    pose.translation = in.vector();
    return pose;
}

void save(const PersistentPoint& point, ByteWriter& out) {
    out.put(point.localA);
    out.put(point.localB);
    out.put(point.normalInB);
    out.put(point.signedDistance);
    out.put(point.triangleA);
    out.put(point.triangleB);
    out.put(point.age);
}

bool isTriangleOf(const MeshModel* model, std::uint32_t triangle) {
    return triangle == noTriangle || (model != nullptr && triangle < model->tree.triangles.size());
}

PersistentPoint loadPoint(ByteReader& in, const LoadedModels& models) {
    PersistentPoint point;
    point.localA = in.vector();
    point.localB = in.vector();
    point.normalInB = in.vector();
    point.signedDistance = in.get<float>();
    point.triangleA = in.get<std::uint32_t>();
    point.triangleB = in.get<std::uint32_t>();
    point.age = in.get<std::uint32_t>();
    in.require(point.localA.allFinite() && point.localB.allFinite() && point.normalInB.allFinite() &&
                   std::isfinite(point.signedDistance),
               "a point that is no number");
    in.require(isTriangleOf(models.a, point.triangleA) && isTriangleOf(models.b, point.triangleB),
               "a triangle that does not exist");
    return point;
}

std::vector<LeafPair> loadCandidates(ByteReader& in, const LoadedModels& models) {
    std::vector<LeafPair> candidates(in.count(sizeof(LeafPair)));
    for (LeafPair& pair : candidates) {
        pair.leafA = in.get<std::uint32_t>();
        pair.leafB = in.get<std::uint32_t>();
        const std::size_t leavesOfB = models.b != nullptr ? models.b->tree.leaves.size() : 1;
        in.require(!models.sameTrees || (pair.leafA < models.a->tree.leaves.size() && pair.leafB < leavesOfB),
                   "a leaf that does not exist");
    }
    return candidates;
}

std::vector<OpenChild> loadOpenChildren(ByteReader& in, const LoadedModels& models) {
    std::vector<OpenChild> open(in.count(sizeof(float) + sizeof(ChildRef)));
    for (OpenChild& child : open) {
        child.distance = in.get<float>();
        child.child = in.get<ChildRef>();
        const Tree& tree = models.a->tree;
        const std::size_t count = isLeaf(child.child) ? tree.leaves.size() : tree.nodes.size();
        in.require(!models.sameTrees || (indexOf(child.child) < count && !std::isnan(child.distance)),
                   "a node that does not exist");
    }
    return open;
}

}  // namespace

void save(const ContactSet& set, ByteWriter& out) {
    out.put(static_cast<std::uint64_t>(set.slots.size()));
    for (const RegionSlot& slot : set.slots) {
        out.put(slot.id);
        out.put(slot.count);
        for (int i = 0; i < slot.count; ++i) {
            save(slot.points[static_cast<std::size_t>(i)], out);
        }
        out.put(slot.normalInB);
        out.put(slot.centerInA);
        out.put(slot.depth);
    }
    out.put(set.nextId);
    out.put(set.droppedRegions);
}

ContactSet loadContactSet(ByteReader& in, const LoadedModels& models) {
    ContactSet set;
    set.slots.resize(in.count(2 * sizeof(std::uint32_t)));
    in.require(set.slots.size() <= mostSlots, std::to_string(set.slots.size()) + " regions");
    for (RegionSlot& slot : set.slots) {
        slot.id = in.get<std::uint32_t>();
        slot.count = in.get<int>();
        in.require(slot.count >= 0 && slot.count <= maxPointsPerRegion, std::to_string(slot.count) + " points");
        for (int i = 0; i < slot.count; ++i) {
            slot.points[static_cast<std::size_t>(i)] = loadPoint(in, models);
        }
        slot.normalInB = in.vector();
        slot.centerInA = in.vector();
        slot.depth = in.get<float>();
        in.require(slot.normalInB.allFinite() && slot.centerInA.allFinite() && !std::isnan(slot.depth),
                   "a region that is no number");
    }
    set.nextId = in.get<std::uint32_t>();
    set.droppedRegions = in.get<std::uint32_t>();
    return set;
}

void save(const PairState& state, ByteWriter& out) {
    save(state.contacts, out);
    out.put(static_cast<std::uint64_t>(state.candidates.size()));
    for (const LeafPair& pair : state.candidates) {
        out.put(pair.leafA);
        out.put(pair.leafB);
    }
    save(state.candidatePose, out);
    out.put(state.candidateDistance);
    // Behind its size, so that it can be left out by whoever has other trees.
    std::vector<std::byte> traversal;
    if (state.traversal) {
        ByteWriter writer(traversal);
        state.traversal->save(writer);
    }
    out.put(static_cast<std::uint64_t>(traversal.size()));
    out.put(std::span<const std::byte>(traversal));
    out.put(static_cast<std::uint64_t>(state.openChildren.size()));
    for (const OpenChild& open : state.openChildren) {
        out.put(open.distance);
        out.put(open.child);
    }
    out.put(state.traversalDistance);
    out.put(state.traversalWork);
    out.put(static_cast<std::uint64_t>(state.nextCandidate));
    save(state.searchPose, out);
    out.put(state.searchDistance);
    out.put(static_cast<std::uint8_t>(state.searchHolds));
    out.put(static_cast<std::uint8_t>(state.cutShort));
    out.put(state.step);
    const std::vector<std::byte> tracker = state.tracker ? state.tracker->save() : std::vector<std::byte>();
    out.put(static_cast<std::uint64_t>(tracker.size()));
    out.put(std::span<const std::byte>(tracker));
}

namespace {

std::optional<Tracker> loadTracker(ByteReader& in, const LoadedModels& models) {
    const std::span<const std::byte> bytes = in.take(in.count(1));
    const bool usable = models.sameTrees && models.b != nullptr && models.a->features && models.b->features;
    if (bytes.empty() || !usable) {
        return std::nullopt;
    }
    std::optional<Tracker> tracker(std::in_place, models.a->features->balls, models.b->features->balls);
    std::string fault;
    try {
        tracker->load(bytes);
    } catch (const Error& error) {
        fault = error.what();
    }
    in.require(fault.empty(), fault);
    return tracker;
}

}  // namespace

PairState loadPairState(ByteReader& in, const LoadedModels& models) {
    PairState state;
    state.contacts = loadContactSet(in, models);
    state.candidates = loadCandidates(in, models);
    state.candidatePose = loadPose(in);
    state.candidateDistance = in.get<float>();
    const std::span<const std::byte> traversal = in.take(in.count(1));
    if (!traversal.empty() && models.sameTrees) {
        in.require(models.b != nullptr, "a search in a solid");
        ByteReader inner(traversal, "search of a saved pair");
        state.traversal = Query::load(models.a->tree, models.b->tree, inner);
        inner.require(inner.left() == 0, "more bytes");
    }
    state.openChildren = loadOpenChildren(in, models);
    state.traversalDistance = in.get<float>();
    state.traversalWork = in.get<std::uint64_t>();
    const auto next = in.get<std::uint64_t>();
    in.require(next <= state.candidates.size(), "candidate " + std::to_string(next));
    state.nextCandidate = static_cast<std::size_t>(next);
    state.searchPose = loadPose(in);
    state.searchDistance = in.get<float>();
    state.searchHolds = in.flag();
    state.cutShort = in.flag();
    state.step = in.get<std::uint64_t>();
    state.tracker = loadTracker(in, models);
    if (!models.sameTrees) {
        forgetSearch(state);
    }
    return state;
}

}  // namespace grapeshot
