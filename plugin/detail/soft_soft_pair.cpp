#include <grapeshot/plugin/detail/soft_soft_pair.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <grapeshot/plugin/detail/bring_back.hpp>
#include <grapeshot/plugin/detail/convert.hpp>
#include <grapeshot/plugin/detail/repulsion_writer.hpp>
#include <grapeshot/plugin/detail/soft_contact_writer.hpp>
#include <grapeshot/scf/near_vertices.hpp>
#include <grapeshot/scf/stretch.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

using Positions = std::vector<Eigen::Vector3f>;

/// At rest, of the distance. Two edges whose ends are at least 1 away from each other's surfaces are .6 apart or more
/// then; of what is stretched much that edges do not cross must do.
constexpr float longestFineEdge = 1.6F;
/// Between edges, of the distance: see SurfaceContacts.
constexpr float edgeReach = 0.75F;

Eigen::Vector3f meanWay(const Positions& from, const Positions& to) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < from.size(); ++i) {
        sum += (to[i] - from[i]).cast<double>();
    }
    return (sum / std::max(1.0, static_cast<double>(from.size()))).cast<float>();
}

/// Moves all by the same; returns the longest way to the others that is left, m.
float shift(Positions& positions, const Eigen::Vector3f& by, const Positions& others) {
    float most = 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
        positions[i] += by;
        most = std::max(most, (positions[i] - others[i]).squaredNorm());
    }
    return std::sqrt(most);
}

}  // namespace

void SoftSoftPair::forget() {
    m_sides.clear();
    m_a.last.clear();
    m_b.last.clear();
    m_contacts.clear();
}

bool SoftSoftPair::findSurfaces(btSoftBody& a, btSoftBody& b, const SoftSoftTask& task, std::string& refusal) {
    m_itself = &a == &b;
    bool changed = false;
    for (auto& [side, body] : {std::pair<Side&, btSoftBody&>(m_a, a), std::pair<Side&, btSoftBody&>(m_b, b)}) {
        if (side.body != &body || side.entry == nullptr) {
            side.body = &body;
            side.entry = m_context.softEntries.entry(body);
        }
        auto surface = side.entry->surface(body, task.look);
        if (!surface) {
            refusal = side.entry->error();
            return false;
        }
        changed = changed || surface != side.surface;
        side.surface = std::move(surface);
    }
    if (changed || m_near == nullptr) {
        forget();
        m_origin = a.m_nodes[0].m_x;
        m_nearDistance = -1;
        const auto treeOf = [](const Side& side) {
            return std::shared_ptr<const BallTree>(side.surface, &side.surface->tree);
        };
        m_near = std::make_unique<NearPairs>(treeOf(m_a), treeOf(m_b));
        m_facing.reset();
    }
    if (m_itself && m_nearDistance != task.distance) {
        m_nearDistance = task.distance;
        m_nearVertices = nearVertices(m_a.surface->tree.surface, 1.5F * task.distance);
    }
    return true;
}

/// Both bodies may fly together: their mean motion is of no concern.
bool SoftSoftPair::readPositions(btSoftBody& a, btSoftBody& b, const SoftSoftTask& task) {
    const btTransform frame(btMatrix3x3::getIdentity(), m_origin);
    const auto read = [&](Side& side, const btSoftBody& body) {
        if (task.world == SoftWorld::velocities) {
            return deformedPositionsOf(body, *side.surface, 0, frame, side.before) &&
                   deformedPositionsOf(body, *side.surface, task.timeStep, frame, side.after);
        }
        return positionsOf(body, *side.surface, frame, frame, side.before, side.after);
    };
    if (!read(m_a, a) || (!m_itself && !read(m_b, b))) {
        return false;
    }
    const auto mean = [&](Positions Side::*from, Positions Side::*to) {
        const Eigen::Vector3f ofA = meanWay(m_a.*from, m_a.*to);
        return m_itself ? ofA : Eigen::Vector3f(0.5F * (ofA + meanWay(m_b.*from, m_b.*to)));
    };
    const bool known = m_a.last.size() == m_a.before.size() && (m_itself || m_b.last.size() == m_b.before.size());
    const Eigen::Vector3f past = known ? mean(&Side::last, &Side::before) : Eigen::Vector3f::Zero();
    m_drift = mean(&Side::before, &Side::after);
    float way = 0;
    float lastWay = 0;
    for (Side* side : {&m_a, &m_b}) {
        way = std::max(way, shift(side->after, -m_drift, side->before));
        lastWay = known ? std::max(lastWay, shift(side->last, past, side->before)) : 0;
    }
    // Somebody has put a body elsewhere: what it passed on that way is of no concern.
    if (!known || lastWay > 4 * (way + m_usualWay) + 0.5F * m_a.surface->meanEdge) {
        m_sides.clear();
        m_a.last = m_a.before;
        m_b.last = m_b.before;
    }
    m_usualWay = way;
    return true;
}

SurfaceInStep SoftSoftPair::inStep(const Side& side) const {
    SurfaceInStep step{side.last,
                       side.before,
                       side.after,
                       side.surface->triangles(),
                       &side.surface->owners,
                       &side.surface->tree.surface};
    step.solid = side.surface->solid;
    step.thread = side.surface->thread;
    return step;
}

Faced SoftSoftPair::findFaced(float distance, std::uint64_t mostWork, NearResult& result) {
    const BallTree& a = m_a.surface->tree;
    const BallTree& b = m_itself ? a : m_b.surface->tree;
    if (m_facing == nullptr) {
        m_facing = std::make_unique<FacingQuery>(a, b);
    }
    const auto wayOf = [](const Side& side) {
        return SurfaceWay{side.last, side.before, side.after, measureStretch(side.surface->tree.surface, side.before)};
    };
    const SurfaceWay first = wayOf(m_a);
    const bool edges = std::max(a.surface.longestEdge, b.surface.longestEdge) > longestFineEdge * distance;
    m_facing->find(first, m_itself ? first : wayOf(m_b), distance, edges ? edgeReach * distance : 0,
                   m_itself ? &m_nearVertices : nullptr, m_faced, mostWork);
    m_pairs.swap(m_faced.meeting);
    result.work = m_faced.work;
    result.certain = m_faced.complete;
    result.stop = m_faced.fault ? StopReason::invalidInput : StopReason::certain;
    return {m_faced.ofA, m_faced.ofB, edges};
}

std::optional<Faced> SoftSoftPair::tryFaced(const SoftSoftTask& task, NearResult& result) {
    if (task.budget.time != never) {
        return std::nullopt;
    }
    std::uint64_t most = unlimited;
    if (task.budget.work != unlimited) {
        // What fails leaves enough for a sample.
        most = task.budget.work - task.budget.work / 4;
        if (m_facedNeed > task.budget.work / 2) {
            m_facedNeed -= m_facedNeed / 16;
            return std::nullopt;
        }
    }
    Faced faced = findFaced(task.distance, most, result);
    m_facedNeed = m_faced.complete ? m_faced.work : std::max(2 * m_facedNeed, task.budget.work);
    const bool isAnswer = m_faced.complete || m_faced.fault;
    return isAnswer ? std::optional(faced) : std::nullopt;
}

SoftPairResult SoftSoftPair::process(btSoftBody& a, btSoftBody& b, const SoftSoftTask& task) {
    SoftPairResult result;
    m_contacts.clear();
    if (task.world == SoftWorld::velocities) {
        // Nobody there reads or clears what Bullet makes for VF_SS.
        a.m_scontacts.resizeNoInitialize(0);
        b.m_scontacts.resizeNoInitialize(0);
    }
    if (!findSurfaces(a, b, task, result.refusal)) {
        forget();
        return result;
    }
    if (!readPositions(a, b, task)) {
        result.refusal = "a node's position is no number";
        forget();
        return result;
    }
    const SurfaceInStep first = inStep(m_a);
    const SurfaceInStep second = inStep(m_itself ? m_a : m_b);
    NearSettings settings;
    settings.distance = task.distance;
    settings.spacing = task.spacing > 0 ? task.spacing : 0.5F * std::min(m_a.surface->meanEdge, m_b.surface->meanEdge);
    settings.exclusion = task.exclusion;
    settings.thin = m_itself && task.spacing > 0;
    settings.near = &m_nearVertices;
    settings.seed = m_context.settings.seed;
    settings.pair = task.key;
    settings.budget = task.budget;
    const bool canFace = task.exclusion == 0 && !settings.thin && !first.thread && !second.thread;
    const std::optional<Faced> faced = canFace ? tryFaced(task, result.near) : std::nullopt;
    if (!faced) {
        const std::uint64_t tried = result.near.work;
        settings.budget.work -= settings.budget.work == unlimited ? 0 : std::min(settings.budget.work, tried);
        result.near = m_near->find(first, second, settings, m_pairs);
        result.near.work += tried;
    }
    if (result.near.stop == StopReason::invalidInput) {
        result.refusal = "a position is no number";
        forget();
        return result;
    }
    result.pairs = m_pairs.size();
    m_sides.find(first, second, m_pairs, static_cast<double>(task.distance), m_itself ? &m_nearVertices : nullptr,
                 m_contacts, faced ? &*faced : nullptr);
    for (const SoftSurfaceContact& contact : m_contacts) {
        result.crossings += contact.crossing ? 1 : 0;
        result.deepest = std::max(result.deepest, task.distance - contact.before);
    }
    result.contacts = write(a, b, task);
    for (Side* side : {&m_a, &m_b}) {
        side->last.swap(side->before);
    }
    return result;
}

int SoftSoftPair::write(btSoftBody& a, btSoftBody& b, const SoftSoftTask& task) {
    for (btSoftBody* body : {&a, &b}) {
        if (!body->isActive()) {
            // Whose solver sleeps has not cleared its contacts.
            body->m_scontacts.resizeNoInitialize(0);
            body->m_faceNodeContacts.resizeNoInitialize(0);
        }
    }
    if (m_contacts.empty() || !(a.isActive() || b.isActive())) {
        return 0;
    }
    const bool velocities = task.world == SoftWorld::velocities;
    a.activate();
    b.activate();
    const MovableBodies movable{&a, &b, m_a.surface->thread, m_b.surface->thread};
    const auto hardness = static_cast<double>(btMin(a.m_cfg.kSHR, b.m_cfg.kSHR));
    bringBack({movable, static_cast<double>(task.distance), 0.5 * hardness, btMatrix3x3::getIdentity()}, a, &b,
              &m_a.before, &m_b.before, m_contacts);
    const SoftContactSite site{a, b, *m_a.entry, *m_b.entry};
    int written = 0;
    for (const SoftSurfaceContact& contact : m_contacts) {
        m_parts.clear();
        appendNodeFaces(site, contact, velocities ? btScalar(0.3) : btScalar(0.05), m_parts);
        for (const NodeFace& part : m_parts) {
            if (velocities) {
                const bool ofB = contact.features == Features::faceCorner;
                btSoftBody::Face& atNode =
                    ofB ? site.entryB.face(b, contact.pair.triangleB) : site.entryA.face(a, contact.pair.triangleA);
                written += writeRepulsion(part, atNode, btScalar(task.distance - contact.before));
            } else {
                const float further = std::min(task.distance, contact.before) - contact.after;
                written += writeSoftContact(part, btScalar(further)) ? 1 : 0;
            }
        }
    }
    return written;
}

void SoftSoftPair::appendContacts(const btSoftBody& body, std::vector<SoftContact>& contacts) const {
    const bool isA = m_a.body == &body;
    if (!isA && m_b.body != &body) {
        return;
    }
    const Side& mine = isA ? m_a : m_b;
    const Side& other = isA ? m_b : m_a;
    for (const SoftSurfaceContact& contact : m_contacts) {
        SoftContact told = isA ? toldOf(contact.a, contact.weightsA, mine.surface->nodes)
                               : toldOf(contact.b, contact.weightsB, mine.surface->nodes);
        const SoftContact others = isA ? toldOf(contact.b, contact.weightsB, other.surface->nodes)
                                       : toldOf(contact.a, contact.weightsA, other.surface->nodes);
        told.otherNodes = others.nodes;
        told.otherWeights = others.weights;
        told.other = other.body;
        told.normal = isA ? contact.normal : Eigen::Vector3f(-contact.normal);
        told.distance = contact.before;
        told.predicted = contact.after;
        told.passing = contact.crossing;
        contacts.push_back(told);
    }
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
