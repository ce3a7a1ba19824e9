#include <grapeshot/scf/facing.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <utility>

#include <grapeshot/scf/detail/leaf_ways.hpp>
#include <grapeshot/scf/detail/pair_space.hpp>
#include <grapeshot/scf/detail/point_kernels.hpp>

namespace grapeshot {

using detail::BallPair;
using detail::PosedLeaf;
using detail::PosedTree;

namespace {

constexpr float sameDirection = 0.8F;  // cosine
constexpr int mostPlaces = 3;          // of a vertex
constexpr float onSurface = 1e-18F;    // m^2

/// Per leaf: vertices that are its to ask for.
IndexLists ownedVertices(const BallTree& tree) {
    std::vector<bool> taken(tree.surface.rest.size(), false);
    IndexLists owned;
    owned.begin.push_back(0);
    for (std::uint32_t leaf = 0; leaf < tree.leaves.size(); ++leaf) {
        for (const std::uint32_t vertex : tree.leafVertices.of(leaf)) {
            if (!taken[vertex]) {
                taken[vertex] = true;
                owned.all.push_back(vertex);
            }
        }
        owned.begin.push_back(static_cast<std::uint32_t>(owned.all.size()));
    }
    return owned;
}

struct Hit {
    float square = 0;
    Eigen::Vector3f between;
    std::uint32_t triangle = 0;
    int feature = 6;
};

/// The leaves near one leaf, and their boxes side by side.
struct Partners {
    std::vector<const PosedLeaf*> leaves;
    std::vector<std::uint32_t> index;
    std::vector<float> low[3], high[3], out;
};

}  // namespace

struct FacingQuery::State {
    /// One surface, before and after the step.
    struct Side {
        explicit Side(const BallTree& tree) : before(tree), after(tree), ways(tree), owned(ownedVertices(tree)) {}
        void begin(const SurfaceWay& way) {
            // Beyond that, balls are fitted.
            before.begin(way.before, nullptr, way.stretch <= 2 ? std::max(1.0F, way.stretch) : 0);
            after.begin(way.after, nullptr, 1);
            ways.begin(way.last, way.before, way.after);
        }
        [[nodiscard]] const BallTree& tree() const { return before.tree(); }

        PosedTree before, after;
        detail::LeafWays ways;
        IndexLists owned;
    };

    State(const BallTree& first, const BallTree& second) : a(first) {
        if (&first != &second) {
            other.emplace(second);
        }
    }
    Side& b() { return other ? *other : a; }
    [[nodiscard]] bool isSelf() const { return !other; }

    /// Pairs of leaves that are within the distance after the step, and what meets.
    void search(float distance, float reach, std::vector<TrianglePair>& meeting);
    void listMeeting(const BallPair& leaves, float reach, std::vector<TrianglePair>& meeting);
    /// Of pairs of leaves: `partners` of each one together.
    void group(bool byA, std::size_t leaves);
    void ask(Side& asking, Side& asked, float distance, const IndexLists* apart, std::vector<FacingPlace>& out);
    void gather(PosedTree& asked, std::span<const std::uint32_t> list);
    void hitsOf(const Eigen::Vector3f& point, const BallTree& tree, float most, bool isSelf);
    void choose(std::uint32_t vertex, const Eigen::Vector3f& point, const PosedTree& asked,
                std::vector<FacingPlace>& out);

    Side a;
    std::optional<Side> other;
    std::vector<BallPair> stack, leafPairs;
    IndexLists partnersOf;
    Partners partners;
    std::vector<Hit> hits;
    std::vector<std::uint32_t> stamps;  // per vertex: the last one that it is apart from
    PosedLeaf sweptA{}, sweptB{};
    std::uint64_t work = 0;
    std::uint64_t mostWork = unlimited;
};

FacingQuery::FacingQuery(const BallTree& a, const BallTree& b) : m_state(std::make_unique<State>(a, b)) {}
FacingQuery::FacingQuery(FacingQuery&&) noexcept = default;
FacingQuery& FacingQuery::operator=(FacingQuery&&) noexcept = default;
FacingQuery::~FacingQuery() = default;

void FacingQuery::State::listMeeting(const BallPair& leaves, float reach, std::vector<TrianglePair>& meeting) {
    const auto& trianglesA = a.tree().leaves[leaves.a].triangle;
    const auto& trianglesB = b().tree().leaves[leaves.b].triangle;
    std::uint16_t rows[16] = {};
    for (std::size_t way = 0; way < 2; ++way) {
        const detail::LeafWay& first = a.ways.of(leaves.a);
        const detail::LeafWay& second = b().ways.of(leaves.b);
        if (!detail::mayMeet(first, second, way, reach)) {
            continue;
        }
        const Eigen::Vector3f mean = 0.5F * (first.mean[way] + second.mean[way]);
        a.ways.sweep(leaves.a, way, mean, sweptA);
        b().ways.sweep(leaves.b, way, mean, sweptB);
        std::uint16_t row[16];
        work += detail::closeRows(sweptA, sweptB, reach, -1, row);
        for (std::size_t i = 0; i < 16; ++i) {
            rows[i] = static_cast<std::uint16_t>(rows[i] | row[i]);
        }
    }
    for (unsigned i = 0; i < 16; ++i) {
        for (std::uint32_t left = rows[i]; left != 0U; left &= left - 1U) {
            TrianglePair pair{trianglesA[i], trianglesB[static_cast<unsigned>(std::countr_zero(left))]};
            if (isSelf()) {
                // Of a leaf with itself each pair stands twice.
                if ((leaves.a == leaves.b && pair.triangleA >= pair.triangleB) ||
                    detail::shareCorner(a.tree().surface, pair.triangleA, pair.triangleB)) {
                    continue;
                }
                if (pair.triangleA > pair.triangleB) {
                    std::swap(pair.triangleA, pair.triangleB);
                }
            }
            meeting.push_back(pair);
        }
    }
}

namespace {

bool areNear(const PosedLeaf& a, const PosedLeaf& b, float distance) {
    for (int axis = 0; axis < 3; ++axis) {
        if (a.boxLow[axis] > b.boxHigh[axis] + distance || b.boxLow[axis] > a.boxHigh[axis] + distance) {
            return false;
        }
    }
    return true;
}

}  // namespace

void FacingQuery::State::search(float distance, float reach, std::vector<TrianglePair>& meeting) {
    const float way = a.ways.longest() + b().ways.longest();
    const detail::PairSpace space{&a.before, &b().before, (distance + way) * 1.0001F + reach, -1};
    leafPairs.clear();
    stack.assign(1, {0, 0});
    detail::ChildPairs children;
    while (!stack.empty() && work <= mostWork) {
        const BallPair pair = stack.back();
        stack.pop_back();
        if (!isBallLeaf(pair.a) || !isBallLeaf(pair.b)) {
            work += space.expand(pair, children, nullptr);
            for (std::uint32_t left = children.mask; left != 0U; left &= left - 1U) {
                stack.push_back(children.at(static_cast<unsigned>(std::countr_zero(left))));
            }
            continue;
        }
        const BallPair leaves{ballIndex(pair.a), ballIndex(pair.b)};
        listMeeting(leaves, reach, meeting);
        if (areNear(a.after.leaf(leaves.a), b().after.leaf(leaves.b), distance)) {
            leafPairs.push_back(leaves);
            if (isSelf() && leaves.a != leaves.b) {
                leafPairs.push_back({leaves.b, leaves.a});
            }
        }
    }
}

void FacingQuery::State::group(bool byA, std::size_t leaves) {
    partnersOf.begin.assign(leaves + 1, 0);
    partnersOf.all.resize(leafPairs.size());
    const auto own = [byA](const BallPair& pair) { return byA ? pair.a : pair.b; };
    for (const BallPair& pair : leafPairs) {
        ++partnersOf.begin[own(pair) + 1];
    }
    for (std::size_t i = 0; i < leaves; ++i) {
        partnersOf.begin[i + 1] += partnersOf.begin[i];
    }
    for (const BallPair& pair : leafPairs) {
        partnersOf.all[partnersOf.begin[own(pair)]++] = byA ? pair.b : pair.a;
    }
    for (std::size_t i = leaves; i > 0; --i) {
        partnersOf.begin[i] = partnersOf.begin[i - 1];
    }
    partnersOf.begin[0] = 0;
}

void FacingQuery::State::gather(PosedTree& asked, std::span<const std::uint32_t> list) {
    partners.leaves.clear();
    partners.index.assign(list.begin(), list.end());
    for (int axis = 0; axis < 3; ++axis) {
        partners.low[axis].clear();
        partners.high[axis].clear();
    }
    for (const std::uint32_t index : list) {
        const PosedLeaf& leaf = asked.leaf(index);
        partners.leaves.push_back(&leaf);
        for (int axis = 0; axis < 3; ++axis) {
            partners.low[axis].push_back(leaf.boxLow[axis]);
            partners.high[axis].push_back(leaf.boxHigh[axis]);
        }
    }
    partners.out.resize(list.size());
}

void FacingQuery::State::hitsOf(const Eigen::Vector3f& point, const BallTree& tree, float most, bool isSelf) {
    hits.clear();
    const std::size_t count = partners.leaves.size();
    for (std::size_t i = 0; i < count; ++i) {
        float square = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const float below = partners.low[axis][i] - point[axis];
            const float above = point[axis] - partners.high[axis][i];
            const float out = std::max(0.0F, std::max(below, above));
            square += out * out;
        }
        partners.out[i] = square;
    }
    const float at[3] = {point[0], point[1], point[2]};
    detail::PointDistances found;
    for (std::size_t i = 0; i < count; ++i) {
        if (!(partners.out[i] < most) || work > mostWork) {
            continue;
        }
        ++work;
        const BallLeaf& leaf = tree.leaves[partners.index[i]];
        std::uint32_t near = detail::pointDistances(*partners.leaves[i], at, most, found);
        near &= (1U << leaf.count) - 1U;
        for (; near != 0U; near &= near - 1U) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(near));
            const auto isApart = [&](std::size_t corner) {
                return isSelf && stamps[leaf.corner[corner][lane]] == stamps.back();
            };
            if (found.square[lane] > onSurface && !isApart(0) && !isApart(1) && !isApart(2)) {
                hits.push_back({found.square[lane],
                                {found.between[0][lane], found.between[1][lane], found.between[2][lane]},
                                leaf.triangle[lane],
                                static_cast<int>(found.feature[lane])});
            }
        }
    }
}

namespace {

/// Does no direction along the surface lead nearer? Of a point within a face none does.
bool isLocalMinimum(const Hit& hit, const Eigen::Vector3f& point, const PosedTree& asked) {
    if (hit.feature == 6) {
        return true;
    }
    const Surface& surface = asked.tree().surface;
    const Triangle& corners = surface.triangles[hit.triangle];
    const Eigen::Vector3f foot = point - hit.between;
    const auto leadsNearer = [&](std::uint32_t vertex) {
        const Eigen::Vector3f way = asked.point(vertex) - foot;
        return hit.between.dot(way) > 1e-4F * std::sqrt(hit.square * way.squaredNorm());
    };
    const auto first = static_cast<std::size_t>(hit.feature % 3);
    const std::uint32_t v = corners[first];
    if (hit.feature < 3) {
        return std::ranges::none_of(surface.ring.of(v), leadsNearer);
    }
    const std::uint32_t w = corners[(first + 1) % 3];
    return std::ranges::none_of(surface.fan.of(v), [&](std::uint32_t t) {
        const Triangle& other = surface.triangles[t];
        return std::ranges::find(other, w) != other.end() &&
               std::ranges::any_of(other, [&](std::uint32_t u) { return u != v && u != w && leadsNearer(u); });
    });
}

}  // namespace

void FacingQuery::State::choose(std::uint32_t vertex, const Eigen::Vector3f& point, const PosedTree& asked,
                                std::vector<FacingPlace>& out) {
    int taken = 0;
    while (!hits.empty() && taken < mostPlaces) {
        const auto nearest = std::ranges::min_element(hits, [](const Hit& x, const Hit& y) {
            return x.square != y.square ? x.square < y.square : x.triangle < y.triangle;
        });
        const Hit hit = *nearest;
        if (taken > 0 && !isLocalMinimum(hit, point, asked)) {
            *nearest = hits.back();
            hits.pop_back();
            continue;
        }
        ++taken;
        const float distance = std::sqrt(hit.square);
        out.push_back({vertex, hit.triangle, distance});
        std::erase_if(hits, [&](const Hit& beside) {
            return beside.between.dot(hit.between) >= sameDirection * distance * std::sqrt(beside.square);
        });
    }
}

void FacingQuery::State::ask(Side& asking, Side& asked, float distance, const IndexLists* apart,
                             std::vector<FacingPlace>& out) {
    const float most = distance * distance;
    if (apart != nullptr) {
        stamps.assign(asking.tree().surface.rest.size() + 1, 0);  // the last: the one that is asked for
    }
    for (std::uint32_t leaf = 0; leaf < asking.tree().leaves.size(); ++leaf) {
        const auto list = partnersOf.of(leaf);
        if (list.empty()) {
            continue;
        }
        gather(asked.after, list);
        for (const std::uint32_t vertex : asking.owned.of(leaf)) {
            if (work > mostWork) {
                return;
            }
            if (apart != nullptr) {
                stamps.back() = vertex + 1;
                stamps[vertex] = vertex + 1;
                for (const std::uint32_t near : apart->of(vertex)) {
                    stamps[near] = vertex + 1;
                }
            }
            const Eigen::Vector3f point = asking.after.point(vertex);
            hitsOf(point, asked.tree(), most, apart != nullptr);
            choose(vertex, point, asked.after, out);
        }
    }
}

void FacingQuery::find(const SurfaceWay& a, const SurfaceWay& b, float distance, float reach, const IndexLists* apart,
                       FacingResult& result, std::uint64_t mostWork) {
    result.meeting.clear();
    result.ofA.clear();
    result.ofB.clear();
    result.fault.reset();
    result.complete = false;
    result.work = 0;
    State& state = *m_state;
    const auto isOf = [](const SurfaceWay& way, const BallTree& tree) {
        const std::size_t vertices = tree.surface.rest.size();
        return way.last.size() == vertices && way.before.size() == vertices && way.after.size() == vertices;
    };
    if (!isOf(a, state.a.tree()) || !isOf(b, state.b().tree())) {
        result.fault = Fault::topologyChanged;
        return;
    }
    if (!(distance >= 0 && std::isfinite(distance) && reach >= 0 && reach <= distance) ||
        state.isSelf() != (apart != nullptr)) {
        result.fault = Fault::badSetting;
        return;
    }
    state.work = 0;
    state.mostWork = mostWork;
    state.a.begin(a);
    if (!state.isSelf()) {
        state.other->begin(b);
    }
    const float slack = 1e-6F * (state.a.tree().extent + state.b().tree().extent);
    state.search(distance, reach + slack, result.meeting);
    if (state.work <= mostWork) {
        std::ranges::sort(result.meeting);
        state.group(true, state.a.tree().leaves.size());
        state.ask(state.a, state.b(), distance, apart, result.ofA);
        if (!state.isSelf()) {
            state.group(false, state.b().tree().leaves.size());
            state.ask(state.b(), state.a, distance, nullptr, result.ofB);
        }
    }
    result.work = state.work;
    result.complete = state.work <= mostWork;
    if (!result.complete) {
        result.meeting.clear();
        result.ofA.clear();
        result.ofB.clear();
    }
}

}  // namespace grapeshot
