#include <grapeshot/scf/detail/front_file.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace grapeshot::detail {
namespace {

constexpr std::size_t bytesOfRecord = 21;
constexpr std::size_t bytesOfPoint = 12;

void put(const SurfaceBefore& before, ByteWriter& out) {
    out.put(before.isKnown);
    out.put(before.atRest);
    out.put(before.pose.has_value());
    if (before.pose) {
        out.put(before.pose->rotation);
        out.put(before.pose->translation);
    }
    out.put(before.extent);
    out.put(std::uint64_t{before.positions.size()});
    for (const Eigen::Vector3f& position : before.positions) {
        out.put(position);
    }
}

float distanceFrom(ByteReader& in) {
    const auto value = in.get<float>();
    in.require(std::isfinite(value) && value >= 0, "no distance");
    return value;
}

SurfaceBefore surfaceFrom(ByteReader& in, const Surface& surface) {
    SurfaceBefore before;
    before.isKnown = in.flag();
    before.atRest = in.flag();
    if (in.flag()) {
        before.pose.emplace();
        before.pose->rotation = in.matrix();
        before.pose->translation = in.vector();
        in.require(isRigid(*before.pose), "no rigid pose");
    }
    before.extent = distanceFrom(in);
    const std::size_t count = in.count(bytesOfPoint);
    in.require(count == 0 || count == surface.rest.size(), std::to_string(count) + " positions");
    before.positions.resize(count);
    for (Eigen::Vector3f& position : before.positions) {
        position = in.vector();
        in.require(position.allFinite(), "a position that is no number");
    }
    return before;
}

bool isPiece(const BallTree& tree, BallRef ref) {
    return ballIndex(ref) < (isBallLeaf(ref) ? tree.leaves.size() : tree.nodes.size());
}

bool isOrIsChildOf(const BallTree& tree, BallRef parent, BallRef ref) {
    if (ref == parent || isBallLeaf(parent)) {
        return ref == parent;
    }
    const BallNode& node = tree.nodes[ballIndex(parent)];
    return std::find(node.child, node.child + node.count, ref) != node.child + node.count;
}

}  // namespace

void putFront(const FrontMemory& front, ByteWriter& out) {
    out.put(static_cast<std::uint8_t>(front.key.mode));
    out.put(front.key.exclusion);
    out.put(front.key.cells);
    out.put(front.reach);
    put(front.a, out);
    put(front.b, out);
    out.put(std::uint64_t{front.records.size()});
    for (const FrontRecord& record : front.records) {
        out.put(record.pair.a);
        out.put(record.pair.b);
        out.put(record.size);
        out.put(record.slack);
        out.put(record.weight);
        out.put(record.isEnd);
    }
}

FrontMemory frontFrom(ByteReader& in, const TrackedTrees& trees) {
    FrontMemory front;
    const auto mode = in.get<std::uint8_t>();
    in.require(mode <= static_cast<std::uint8_t>(TrackMode::budget), "no mode");
    front.key.mode = static_cast<TrackMode>(mode);
    front.key.exclusion = in.get<float>();
    in.require(std::isfinite(front.key.exclusion), "no exclusion");
    front.key.cells = distanceFrom(in);
    front.reach = distanceFrom(in);
    front.a = surfaceFrom(in, trees.a.surface);
    front.b = surfaceFrom(in, trees.b.surface);
    front.records.resize(in.count(bytesOfRecord));
    std::vector<std::size_t> above;  // records that the next one is below
    for (std::size_t i = 0; i < front.records.size(); ++i) {
        FrontRecord& record = front.records[i];
        record.pair.a = in.get<BallRef>();
        record.pair.b = in.get<BallRef>();
        record.size = in.get<std::uint32_t>();
        record.slack = in.get<float>();
        record.weight = in.get<float>();
        record.isEnd = in.flag();
        while (!above.empty() && i == above.back() + front.records[above.back()].size) {
            above.pop_back();
        }
        const std::size_t end = above.empty() ? front.records.size() : above.back() + front.records[above.back()].size;
        in.require(record.size >= 1 && record.size <= end - i && (!record.isEnd || record.size == 1),
                   "a pair of " + std::to_string(record.size) + " records");
        in.require(!std::isnan(record.slack) && record.weight >= 0 && record.weight <= 1, "a weight out of range");
        const BallPair parent = above.empty() ? BallPair{0, 0} : front.records[above.back()].pair;
        const bool isThere = isPiece(trees.a, record.pair.a) && isPiece(trees.b, record.pair.b) &&
                             isOrIsChildOf(trees.a, parent.a, record.pair.a) &&
                             isOrIsChildOf(trees.b, parent.b, record.pair.b);
        in.require(isThere && (i == 0) == above.empty() && (i == 0) == (record.pair == parent),
                   "a pair that is in no traversal");
        above.push_back(i);
    }
    return front;
}

}  // namespace grapeshot::detail
