#include <grapeshot/scf/detail/depth_step.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

namespace grapeshot::detail {
namespace {

constexpr std::size_t mostStarts = 24;  // contacts of a region from whose corners it is climbed

}  // namespace

DepthBody::DepthBody(const BallTree& tree)
    : topology(buildTopology(tree.surface.mesh())), isSolid(topology.closed), pieceOf(tree.surface.rest.size(), 0) {
    const Surface& surface = tree.surface;
    double volume = 0;
    for (const Triangle& t : surface.triangles) {
        const Eigen::Vector3d c = surface.rest[t[2]].cast<double>();
        volume += surface.rest[t[0]].cast<double>().cross(surface.rest[t[1]].cast<double>()).dot(c);
    }
    outwards = volume < 0 ? -1 : 1;
    std::vector<char> isReached(surface.rest.size(), 0);
    std::vector<std::uint32_t> open;
    for (const Triangle& t : surface.triangles) {
        const std::uint32_t seed = topology.welded[t[0]];
        if (isReached[seed] != 0) {
            continue;
        }
        const auto piece = static_cast<std::uint32_t>(pieceAt.size());
        pieceAt.push_back(seed);
        isReached[seed] = 1;
        open.assign(1, seed);
        while (!open.empty()) {
            const std::uint32_t vertex = open.back();
            open.pop_back();
            pieceOf[vertex] = piece;
            for (const std::uint32_t neighbour : topology.ringOf(vertex)) {
                if (isReached[neighbour] == 0) {
                    isReached[neighbour] = 1;
                    open.push_back(neighbour);
                }
            }
        }
    }
}

int DepthStep::sideOf(bool ofB, std::uint32_t contact) const {
    if (isSheet()) {
        return ofB ? m_sides[contact].ofB : m_sides[contact].ofA;
    }
    return ofB ? m_bodyB.outwards : m_bodyA.outwards;
}

Eigen::Vector3f DepthStep::middleOf(std::uint32_t triangleOfA) const {
    const Triangle& t = m_a.tree().tree().surface.triangles[triangleOfA];
    return (m_a.tree().point(t[0]) + m_a.tree().point(t[1]) + m_a.tree().point(t[2])) / 3;
}

bool DepthStep::place() {
    m_scratch.points.clear();
    m_scratch.cuts.clear();
    for (std::uint32_t i = 0; i < m_contacts.size(); ++i) {
        const TrackedContact& contact = m_contacts[i];
        // Of sheets every contact may be beyond: whether it is, the height of its corners says.
        if (contact.overlapping || isSheet()) {
            m_scratch.cuts.push_back(i);
            m_scratch.points.emplace_back(0.5F * (contact.onA + contact.onB));
        }
    }
    for (const DepthMemory::Summit& summit : m_before->summits) {
        for (const std::uint32_t anchor : summit.anchors) {
            m_scratch.points.push_back(middleOf(anchor));
        }
    }
    if (!std::ranges::all_of(m_scratch.points, [](const Eigen::Vector3f& point) { return point.allFinite(); })) {
        return false;
    }
    const auto count = static_cast<std::uint32_t>(m_scratch.points.size());
    m_scratch.isTaken.assign(count, 0);
    if (m_settings.spacing == 0) {
        joinAlongCuts();
        return true;
    }
    m_scratch.grid.reset(count, m_settings.spacing);
    for (std::uint32_t i = count; i-- > 0;) {
        m_scratch.grid.insert(i, m_scratch.points[i]);
    }
    return true;
}

std::uint32_t DepthStep::rootOf(std::uint32_t point) {
    std::vector<std::uint32_t>& root = m_scratch.root;
    while (root[point] != point) {
        point = root[point] = root[root[point]];
    }
    return point;
}

/// The lowest point stands for its component.
void DepthStep::join(std::uint32_t first, std::uint32_t second) {
    first = rootOf(first);
    second = rootOf(second);
    m_scratch.root[std::max(first, second)] = std::min(first, second);
}

void DepthStep::markCutPieces(bool ofA) {
    const DepthBody& body = ofA ? m_bodyA : m_bodyB;
    const Surface& surface = (ofA ? m_a : m_b).tree().tree().surface;
    std::vector<char>& isCut = ofA ? m_scratch.isCutA : m_scratch.isCutB;
    isCut.assign(body.pieceAt.size(), 0);
    for (const std::uint32_t index : m_scratch.cuts) {
        const TrianglePair& pair = m_contacts[index].pair;
        const Triangle& triangle = surface.triangles[ofA ? pair.triangleA : pair.triangleB];
        isCut[body.pieceOf[body.topology.welded[triangle[0]]]] = 1;
    }
}

void DepthStep::joinAlongCuts() {
    DepthScratch& scratch = m_scratch;
    scratch.root.resize(scratch.points.size());
    std::iota(scratch.root.begin(), scratch.root.end(), 0U);
    scratch.cutAt.clear();
    scratch.cutAtA.clear();
    const std::vector<Triangle>& trianglesA = m_a.tree().tree().surface.triangles;
    const std::vector<Triangle>& trianglesB = m_b.tree().tree().surface.triangles;
    const auto cuts = static_cast<std::uint32_t>(scratch.cuts.size());
    for (std::uint32_t i = 0; i < cuts; ++i) {
        const TrianglePair& pair = m_contacts[scratch.cuts[i]].pair;
        for (const std::uint32_t v : trianglesA[pair.triangleA]) {
            const std::uint64_t vertexA = m_bodyA.topology.welded[v];
            scratch.cutAtA.insert(vertexA, i);
            for (const std::uint32_t w : trianglesB[pair.triangleB]) {
                const auto entry = scratch.cutAt.insert(vertexA << 32U | m_bodyB.topology.welded[w], i);
                if (!entry.isNew) {
                    join(entry.value, i);
                }
            }
        }
    }
    markCutPieces(true);
    markCutPieces(false);
    for (std::uint32_t k = 0; k < m_before->summits.size(); ++k) {
        const DepthMemory::Summit& summit = m_before->summits[k];
        bool isKnown = false;
        for (std::uint32_t i = 0; i < summit.anchors.size(); ++i) {
            const std::uint32_t point = cuts + 4 * k + i;
            scratch.isTaken[point] = 1;
            for (const std::uint32_t v : trianglesA[summit.anchors[i]]) {
                if (const std::uint32_t* cut = scratch.cutAtA.find(m_bodyA.topology.welded[v])) {
                    join(*cut, point);
                    scratch.isTaken[point] = 0;
                    isKnown = true;
                    break;
                }
            }
        }
        const DepthBody& body = summit.isOfA ? m_bodyA : m_bodyB;
        const std::uint32_t piece = body.pieceOf[body.topology.welded[summit.vertex]];
        // Of a piece that is cut elsewhere it may be part of a region that is found from there.
        if (!isKnown && (summit.isOfA ? scratch.isCutA : scratch.isCutB)[piece] == 0) {
            scratch.isTaken[cuts + 4 * k] = 0;
        }
    }
}

void DepthStep::collect(std::uint32_t seed) {
    std::vector<std::uint32_t>& group = m_scratch.group;
    if (m_settings.spacing == 0) {
        group.clear();
        const std::uint32_t root = rootOf(seed);
        for (std::uint32_t i = seed; i < m_scratch.points.size(); ++i) {
            if (m_scratch.isTaken[i] == 0 && rootOf(i) == root) {
                m_scratch.isTaken[i] = 1;
                group.push_back(i);
            }
        }
        return;
    }
    group.assign(1, seed);
    m_scratch.isTaken[seed] = 1;
    m_scratch.open.assign(1, seed);
    const float square = m_settings.spacing * m_settings.spacing;
    while (!m_scratch.open.empty()) {
        const std::uint32_t at = m_scratch.open.back();
        m_scratch.open.pop_back();
        m_scratch.grid.take(m_scratch.points[at], [&](std::uint32_t other) {
            if (m_scratch.isTaken[other] != 0) {
                return true;
            }
            if (!((m_scratch.points[other] - m_scratch.points[at]).squaredNorm() <= square)) {
                return false;
            }
            m_scratch.isTaken[other] = 1;
            group.push_back(other);
            m_scratch.open.push_back(other);
            return true;
        });
    }
    std::sort(group.begin(), group.end());
}

std::optional<Summit> DepthStep::climbFrom(bool ofA) {
    const DepthBody& onto = ofA ? m_bodyB : m_bodyA;
    if (m_scratch.starts.empty() || (!isSheet() && !onto.isSolid)) {
        return std::nullopt;
    }
    return m_scratch.climb.climb(ofA ? m_a : m_b, ofA ? m_b : m_a, m_scratch.starts, !isSheet(), *m_meter, m_out->work);
}

void DepthStep::report(bool ofA, const Summit& summit, std::uint32_t cuts, std::uint32_t age) {
    const DepthSource source = ofA ? DepthSource::vertexOfA : DepthSource::vertexOfB;
    for (DepthRegion& other : m_out->regions) {
        if (other.source == source && other.vertex == summit.vertex) {
            other.contacts += cuts;  // two parts of one cut
            other.age = std::max(other.age, age);
            return;
        }
    }
    const Eigen::Vector3d point = (ofA ? m_a : m_b).tree().point(summit.vertex).cast<double>();
    const Eigen::Vector3d out = (summit.foot.point - point) / summit.foot.distance;
    DepthRegion region;
    region.normal = (ofA ? out : -out).cast<float>();
    region.depth = static_cast<float>(summit.foot.distance);
    (ofA ? region.onA : region.onB) = point.cast<float>();
    (ofA ? region.onB : region.onA) = summit.foot.point.cast<float>();
    region.source = source;
    region.vertex = summit.vertex;
    region.triangle = summit.foot.triangle;
    region.feature = static_cast<std::uint8_t>(summit.foot.feature);
    region.isChecked = summit.isChecked;
    region.contacts = cuts;
    region.age = age;
    m_out->complete = m_out->complete && (summit.isChecked || isSheet());
    m_out->regions.push_back(region);
}

void DepthStep::remember(bool ofA, const Summit& summit, const Anchors& anchors, std::uint32_t age) {
    for (DepthMemory::Summit& other : m_next->summits) {
        if (other.isOfA == ofA && other.vertex == summit.vertex) {
            other.age = std::max(other.age, age);
            return;
        }
    }
    m_next->summits.push_back(
        {summit.vertex, summit.foot.triangle, anchors, age, static_cast<std::int8_t>(summit.side), ofA});
}

void DepthStep::reportCrossing(std::uint32_t cuts) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    const TrackedContact* deepest = nullptr;
    const auto areaOf = [](const SurfaceProbe& side, std::uint32_t triangle) {
        const Triangle& t = side.tree().tree().surface.triangles[triangle];
        const Eigen::Vector3d first = side.tree().point(t[0]).cast<double>();
        const Eigen::Vector3d area =
            (side.tree().point(t[1]).cast<double>() - first).cross(side.tree().point(t[2]).cast<double>() - first);
        return area.norm() > 0 ? Eigen::Vector3d(area.normalized()) : area;
    };
    for (std::uint32_t i = 0; i < cuts; ++i) {
        const std::uint32_t index = m_scratch.cuts[m_scratch.group[i]];
        const TrackedContact& contact = m_contacts[index];
        if (!contact.overlapping) {
            continue;
        }
        sum += sideOf(true, index) * areaOf(m_b, contact.pair.triangleB) -
               sideOf(false, index) * areaOf(m_a, contact.pair.triangleA);
        if (deepest == nullptr || contact.signedDistance < deepest->signedDistance) {
            deepest = &contact;
        }
    }
    if (deepest == nullptr) {
        return;
    }
    DepthRegion region;
    region.normal = sum.norm() > 1e-6 ? Eigen::Vector3f(sum.normalized().cast<float>()) : deepest->normal;
    region.depth = std::max(0.0F, -deepest->signedDistance);
    region.onA = deepest->onA - 0.5F * region.depth * region.normal;
    region.onB = deepest->onB + 0.5F * region.depth * region.normal;
    region.triangle = deepest->pair.triangleB;
    region.contacts = cuts;
    m_out->regions.push_back(region);
}

/// Cuts stand before summits in a group.
void DepthStep::measureGroup() {
    const auto firstSummit = static_cast<std::uint32_t>(m_scratch.cuts.size());
    const std::vector<std::uint32_t>& group = m_scratch.group;
    const auto cuts =
        static_cast<std::uint32_t>(std::lower_bound(group.begin(), group.end(), firstSummit) - group.begin());
    std::optional<Summit> summits[2];
    std::uint32_t age = 0;
    for (const bool ofA : {true, false}) {
        std::vector<ClimbStart>& starts = m_scratch.starts;
        starts.clear();
        for (std::size_t i = cuts; i < group.size(); ++i) {
            const DepthMemory::Summit& summit = m_before->summits[(group[i] - firstSummit) / 4];
            age = std::max(age, summit.age + 1);
            if (summit.isOfA == ofA) {
                starts.push_back({summit.vertex, summit.triangle, summit.side});
            }
        }
        const std::size_t stride = std::max<std::size_t>(1, cuts / mostStarts);
        for (std::size_t i = 0; i < cuts; i += stride) {
            const std::uint32_t index = m_scratch.cuts[group[i]];
            const TrianglePair& pair = m_contacts[index].pair;
            const SurfaceProbe& from = ofA ? m_a : m_b;
            for (const std::uint32_t v : from.tree().tree().surface.triangles[ofA ? pair.triangleA : pair.triangleB]) {
                starts.push_back({v, ofA ? pair.triangleB : pair.triangleA, sideOf(ofA, index)});
            }
        }
        summits[ofA ? 0 : 1] = climbFrom(ofA);
    }
    if (!summits[0] && !summits[1]) {
        reportCrossing(cuts);
        return;
    }
    Anchors anchors = cuts > 0 ? Anchors{} : m_before->summits[(group[0] - firstSummit) / 4].anchors;
    for (std::size_t i = 0; i < anchors.size() && cuts > 0; ++i) {
        anchors[i] = m_contacts[m_scratch.cuts[group[i * cuts / anchors.size()]]].pair.triangleA;
    }
    // The shallower side is not reported, but goes on from there as well.
    const bool ofA = summits[0] && (!summits[1] || summits[0]->foot.distance >= summits[1]->foot.distance);
    report(ofA, *summits[ofA ? 0 : 1], cuts, age);
    for (const bool side : {true, false}) {
        if (const std::optional<Summit>& summit = summits[side ? 0 : 1]) {
            remember(side, *summit, anchors, age);
        }
    }
}

void DepthStep::measureContained(bool ofA) {
    const DepthBody& body = ofA ? m_bodyA : m_bodyB;
    const DepthBody& outer = ofA ? m_bodyB : m_bodyA;
    SurfaceProbe& from = ofA ? m_a : m_b;
    SurfaceProbe& onto = ofA ? m_b : m_a;
    if (!outer.isSolid) {
        return;
    }
    markCutPieces(ofA);
    std::vector<char>& isCut = ofA ? m_scratch.isCutA : m_scratch.isCutB;
    for (const DepthRegion& region : m_out->regions) {
        if (region.source == (ofA ? DepthSource::vertexOfA : DepthSource::vertexOfB)) {
            isCut[body.pieceOf[region.vertex]] = 1;
        }
    }
    for (std::size_t piece = 0; piece < isCut.size(); ++piece) {
        if (isCut[piece] != 0) {
            continue;
        }
        if (m_meter->left(m_out->work) == 0) {
            m_out->complete = false;
            return;
        }
        const std::uint32_t vertex = body.pieceAt[piece];
        const Eigen::Vector3d point = from.tree().point(vertex).cast<double>();
        if (onto.isBeyond(point, m_out->work)) {
            continue;
        }
        const Foot foot = onto.nearest(point, {}, m_out->work);
        if (outer.outwards * onto.heightOver(foot, point) < 0) {
            m_scratch.starts.assign(1, {vertex, foot.triangle, outer.outwards});
            if (const auto summit = climbFrom(ofA)) {
                const std::uint32_t anchor = ofA ? m_a.tree().tree().surface.fan.of(vertex)[0] : summit->foot.triangle;
                report(ofA, *summit, 0, 0);
                remember(ofA, *summit, {anchor, anchor, anchor, anchor}, 0);
            }
        }
    }
}

void DepthStep::run(std::span<const TrackedContact> contacts, std::span<const ContactSides> sides,
                    const DepthMemory& memory, Meter& meter, DepthMemory& next, DepthResult& out) {
    m_contacts = contacts;
    m_sides = sides;
    m_before = &memory;
    m_next = &next;
    m_meter = &meter;
    m_out = &out;
    if (!place()) {
        out.fault = Fault::notFinite;
        return;
    }
    out.complete = true;
    for (std::uint32_t seed = 0; seed < m_scratch.points.size(); ++seed) {
        if (m_scratch.isTaken[seed] != 0) {
            continue;
        }
        collect(seed);
        if (meter.left(out.work) > 0) {
            measureGroup();
            continue;
        }
        out.complete = false;
        for (const std::uint32_t point : m_scratch.group) {
            if (point >= m_scratch.cuts.size()) {
                const DepthMemory::Summit& summit = memory.summits[(point - m_scratch.cuts.size()) / 4];
                if (next.summits.empty() || !(next.summits.back() == summit)) {
                    next.summits.push_back(summit);
                }
            }
        }
    }
    if (m_settings.containment && !isSheet() && &m_bodyA != &m_bodyB) {
        measureContained(true);
        measureContained(false);
    }
}

}  // namespace grapeshot::detail
