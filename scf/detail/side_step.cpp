#include <grapeshot/scf/detail/side_step.hpp>

#include <Eigen/Geometry>
#include <algorithm>

namespace grapeshot::detail {
namespace {

ContactSides swapped(const ContactSides& sides) {
    return {sides.ofB, sides.ofA};
}

/// -1, 0 or 1
int signOf(int votes) {
    return votes > 0 ? 1 : votes < 0 ? -1 : 0;
}

struct CornersOfTriangle {
    CornersOfTriangle(const PosedTree& tree, std::uint32_t triangle) {
        for (std::size_t i = 0; i < 3; ++i) {
            at[i] = tree.point(tree.tree().surface.triangles[triangle][i]).cast<double>();
        }
    }
    [[nodiscard]] Eigen::Vector3d normal() const { return (at[1] - at[0]).cross(at[2] - at[0]); }
    Eigen::Vector3d at[3];
};

/// Where a point of a triangle was at the start of the step.
Eigen::Vector3d pointBefore(const PosedTree& before, const PosedTree& now, std::uint32_t triangle,
                            const Eigen::Vector3f& point) {
    const CornersOfTriangle there(before, triangle);
    const CornersOfTriangle here(now, triangle);
    const Eigen::Vector3d normal = here.normal();
    const double square = normal.squaredNorm();
    if (!(square > 0)) {
        return (there.at[0] + there.at[1] + there.at[2]) / 3;
    }
    const Eigen::Vector3d p = point.cast<double>();
    const double u = std::clamp((here.at[2] - here.at[1]).cross(p - here.at[1]).dot(normal) / square, 0.0, 1.0);
    const double v = std::clamp((here.at[0] - here.at[2]).cross(p - here.at[2]).dot(normal) / square, 0.0, 1.0 - u);
    return u * there.at[0] + v * there.at[1] + (1 - u - v) * there.at[2];
}

/// Ids of the cells around a triangle's, with its own.
void collectAround(const BallTree& tree, const SideCells::OfTree& of, std::uint32_t triangle,
                   std::vector<std::uint32_t>& ids) {
    const Cells& cells = of.cells;
    ids.clear();
    for (const std::uint32_t corner : tree.surface.triangles[triangle]) {
        for (const std::uint32_t neighbour : tree.surface.fan.of(corner)) {
            ids.push_back(cells.idOf(tree, neighbour));
        }
    }
    const std::uint32_t own = cells.idOf(tree, triangle);
    if (own < cells.cells.size()) {
        const auto neighbours = of.neighbours.of(own);
        ids.insert(ids.end(), neighbours.begin(), neighbours.end());
    }
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
}

}  // namespace

bool SideStep::begin(const SurfaceMotion& motionA, const SurfaceMotion& motionB,
                     std::span<const TrackedContact> contacts) {
    const auto place = [](const SurfaceMotion& motion, PosedTree& before, PosedTree& now) {
        const Surface& surface = before.tree().surface;
        const std::span<const Eigen::Vector3f> from = motion.before.empty() ? std::span(surface.rest) : motion.before;
        const Pose end = poseAt(motion.frame, 1);
        before.begin(from, &motion.frame.from, 1);
        now.begin(motion.now.empty() ? from : motion.now, &end, 1);
    };
    place(motionA, m_scratch.beforeA, m_scratch.nowA);
    place(motionB, m_scratch.beforeB, m_scratch.nowB);
    const auto isFinite = [](const PosedTree& tree, std::uint32_t triangle) {
        return std::ranges::all_of(tree.tree().surface.triangles[triangle],
                                   [&](std::uint32_t v) { return tree.point(v).allFinite(); });
    };
    return std::ranges::all_of(contacts, [&](const TrackedContact& contact) {
        return isFinite(m_scratch.beforeA, contact.pair.triangleA) &&
               isFinite(m_scratch.nowA, contact.pair.triangleA) &&
               isFinite(m_scratch.beforeB, contact.pair.triangleB) && isFinite(m_scratch.nowB, contact.pair.triangleB);
    });
}

SideStep::Key SideStep::keyOf(std::uint32_t idA, std::uint32_t idB) const {
    const bool isSwapped = isSelf() && idA > idB;
    const std::uint64_t first = isSwapped ? idB : idA;
    return {first << 32U | (isSwapped ? idA : idB), isSwapped};
}

std::optional<ContactSides> SideStep::inherited(const TrianglePair& pair) {
    collectAround(m_a, m_cells.a, pair.triangleA, m_scratch.aroundA);
    collectAround(m_b, m_cells.b(), pair.triangleB, m_scratch.aroundB);
    SideScratch::Votes votes;
    for (const std::uint32_t idA : m_scratch.aroundA) {
        for (const std::uint32_t idB : m_scratch.aroundB) {
            const Key key = keyOf(idA, idB);
            if (const KeptSides* kept = m_memory.find(key.value)) {
                votes.add(key.isSwapped ? swapped(kept->sides) : kept->sides);
            }
        }
    }
    if (votes.ofA == 0 && votes.ofB == 0 && !m_scratch.votes.empty()) {
        const auto count = [&](const std::vector<std::uint32_t>& ids, KeyMap& crossed) {
            for (const std::uint32_t id : ids) {
                if (const std::uint32_t* index = crossed.find(id)) {
                    votes.ofA += m_scratch.votes[*index].ofA;
                    votes.ofB += m_scratch.votes[*index].ofB;
                }
            }
        };
        count(m_scratch.aroundA, m_scratch.crossedA);
        count(m_scratch.aroundB, m_scratch.crossedB);
    }
    if (votes.ofA == 0 || votes.ofB == 0) {
        return std::nullopt;
    }
    return ContactSides{static_cast<std::int8_t>(signOf(votes.ofA)), static_cast<std::int8_t>(signOf(votes.ofB))};
}

void SideStep::listCrossed() {
    m_scratch.crossedA.clear();
    m_scratch.crossedB.clear();
    m_scratch.votes.clear();
    for (const KeptSides& kept : m_memory.kept) {
        // Of a body with itself a cell does not say which of both it was.
        if (isSelf() || !kept.isCrossed || kept.step + 1 != m_memory.step) {
            continue;
        }
        const std::uint64_t cell[2] = {kept.key >> 32U, kept.key & 0xffffffffU};
        for (int side = 0; side < 2; ++side) {
            const auto [index, isNew] = (side == 0 ? m_scratch.crossedA : m_scratch.crossedB)
                                            .insert(cell[side], static_cast<std::uint32_t>(m_scratch.votes.size()));
            if (isNew) {
                m_scratch.votes.emplace_back();
            }
            m_scratch.votes[index].add(kept.sides);
        }
    }
}

std::optional<ContactSides> SideStep::atStart(const TrackedContact& contact) const {
    const auto sideOf = [](const SurfaceProbe& surface, std::uint32_t triangle, const Eigen::Vector3d& point) {
        std::uint64_t work = 0;
        return surface.sideOf(surface.walk(triangle, point, work), point);
    };
    const TrianglePair& pair = contact.pair;
    const int ofB =
        sideOf(m_beforeB, pair.triangleB, pointBefore(m_scratch.beforeA, m_scratch.nowA, pair.triangleA, contact.onA));
    const int ofA =
        sideOf(m_beforeA, pair.triangleA, pointBefore(m_scratch.beforeB, m_scratch.nowB, pair.triangleB, contact.onB));
    if (ofA == 0 || ofB == 0) {
        return std::nullopt;
    }
    return ContactSides{static_cast<std::int8_t>(ofA), static_cast<std::int8_t>(ofB)};
}

void SideStep::present(const TrackedContact& contact, bool isKnown, SidedContact& sided) const {
    sided.normal = contact.normal;
    sided.signedDistance = contact.signedDistance;
    if (contact.overlapping) {
        const Eigen::Vector3d normal = CornersOfTriangle(m_scratch.nowB, contact.pair.triangleB).normal();
        if (normal.norm() > 0) {
            sided.normal = (static_cast<double>(sided.sides.ofB) * normal.normalized()).cast<float>();
        }
        sided.isCrossed = true;
        return;
    }
    const Eigen::Vector3d onA = contact.onA.cast<double>();
    const Eigen::Vector3d onB = contact.onB.cast<double>();
    const double apart = (onA - onB).norm();
    const int ofB = m_nowB.sideOf({onB, apart, contact.pair.triangleB, contact.featureB}, onA);
    const int ofA = m_nowA.sideOf({onA, apart, contact.pair.triangleA, contact.featureA}, onB);
    if (!isKnown) {
        sided.sides = {static_cast<std::int8_t>(ofA < 0 ? -1 : 1), static_cast<std::int8_t>(ofB < 0 ? -1 : 1)};
        return;
    }
    // One that is past a border says nothing.
    sided.isCrossed = ofB != 0 ? ofB != sided.sides.ofB : ofA != 0 && ofA != sided.sides.ofA;
    if (sided.isCrossed) {
        sided.normal = -contact.normal;
        sided.signedDistance = -contact.signedDistance;
    }
}

void SideStep::decide(std::span<const TrackedContact> contacts, std::vector<SidedContact>& out) {
    m_scratch.asked.clear();
    listCrossed();
    out.reserve(contacts.size());
    for (const TrackedContact& contact : contacts) {
        SidedContact& sided = out.emplace_back();
        const Key key = keyOf(m_cells.a.cells.idOf(m_a, contact.pair.triangleA),
                              m_cells.b().cells.idOf(m_b, contact.pair.triangleB));
        if (const KeptSides* kept = m_memory.find(key.value)) {
            sided.sides = key.isSwapped ? swapped(kept->sides) : kept->sides;
            sided.source = SideSource::kept;
        } else if (const auto around = inherited(contact.pair)) {
            sided.sides = *around;
            sided.source = SideSource::inherited;
        } else if (const auto start = atStart(contact)) {
            sided.sides = *start;
            sided.source = SideSource::start;
        }
        const bool isKnown = sided.source != SideSource::none;
        present(contact, isKnown, sided);
        if (isKnown) {
            m_scratch.asked.push_back(
                {key.value, m_memory.step, key.isSwapped ? swapped(sided.sides) : sided.sides, sided.isCrossed});
        }
    }
}

void SideStep::finish(std::uint32_t keepSteps) {
    m_memory.merge(m_scratch.asked, keepSteps);
    ++m_memory.step;
}

}  // namespace grapeshot::detail
