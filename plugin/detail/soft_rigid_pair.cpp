#include <grapeshot/plugin/detail/soft_rigid_pair.hpp>

#include <LinearMath/btTransformUtil.h>

#include <algorithm>
#include <tuple>
#include <utility>

#include <grapeshot/core/error.hpp>
#include <grapeshot/plugin/detail/bring_back.hpp>
#include <grapeshot/plugin/detail/convert.hpp>
#include <grapeshot/plugin/detail/deformable_contact_writer.hpp>
#include <grapeshot/plugin/detail/shape_kind.hpp>
#include <grapeshot/plugin/detail/share_of_way.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

/// Where the body will be at the end of the step, as far as anybody knows before its contacts are solved.
btTransform endOf(const btCollisionObject& object, btScalar timeStep) {
    btTransform end = object.getWorldTransform();
    const btRigidBody* body = btRigidBody::upcast(&object);
    if (body != nullptr && !(body->isStaticObject())) {
        btVector3 velocity = body->getLinearVelocity();
        if (body->isActive() && !body->isKinematicObject()) {
            velocity += body->getTotalForce() * body->getInvMass() * timeStep;
        }
        btTransformUtil::integrateTransform(object.getWorldTransform(), velocity, body->getAngularVelocity(), timeStep,
                                            end);
    }
    return end;
}

}  // namespace

namespace {

/// How far links may draw each node in this step, m: the strain that it would have, or one whose pull comes to it.
std::vector<float> pullsOf(const btSoftBody& soft, std::size_t vertices) {
    std::vector<float> pulls(vertices, 0.0F);
    const auto pullOf = [&](const btSoftBody::Node* node) -> float& {
        return pulls[static_cast<std::size_t>(node - &soft.m_nodes[0])];
    };
    for (int i = 0; i < soft.m_links.size(); ++i) {
        const btSoftBody::Link& link = soft.m_links[i];
        const btScalar length = (link.m_n[1]->m_x - link.m_n[0]->m_x).length();
        for (const btSoftBody::Node* node : link.m_n) {
            pullOf(node) = std::max(pullOf(node), static_cast<float>(btFabs(length - link.m_rl)));
        }
    }
    for (int pass = 0; pass < soft.m_cfg.piterations; ++pass) {
        for (int i = 0; i < soft.m_links.size(); ++i) {
            const btSoftBody::Link& link = soft.m_links[i];
            const float most = std::max(pullOf(link.m_n[0]), pullOf(link.m_n[1]));
            pullOf(link.m_n[0]) = pullOf(link.m_n[1]) = most;
        }
    }
    return pulls;
}

}  // namespace

SoftWorld rigidWorldOf(const btSoftBody& body) {
    switch (body.m_cfg.collisions & btSoftBody::fCollision::RVSmask) {
        case btSoftBody::fCollision::SDF_RS:
            return SoftWorld::positions;
        case btSoftBody::fCollision::SDF_RD:
            return SoftWorld::velocities;
        default:
            return SoftWorld::neither;
    }
}

void SoftRigidPair::forget() {
    m_sides.clear();
    m_last.clear();
    m_contacts.clear();
}

bool SoftRigidPair::findSurfaces(const btSoftBody& soft, const btCollisionShape& shape, std::uint64_t look,
                                 std::string& refusal) {
    if (m_body != &soft || m_softEntry == nullptr) {
        m_body = &soft;
        m_softEntry = m_context.softEntries.entry(soft);
    }
    if (m_shape != &shape || m_shapeEntry == nullptr) {
        m_shape = &shape;
        m_shapeEntry = ShapeModels::instance().entry(shape);
    }
    const std::uint64_t step = look == 0 ? 0 : (m_context.serial << 40U) + look;
    auto model = m_shapeEntry->model(shape, ShapeModels::instance().cache(), Check::sampled, step);
    auto surface = m_softEntry->surface(soft, look);
    if (!model->mesh || !surface) {
        refusal = surface ? model->error : m_softEntry->error();
        return false;
    }
    if (surface != m_soft || model->mesh != (m_model ? m_model->mesh : nullptr)) {
        forget();
        m_soft = std::move(surface);
        m_model = std::move(model);
        m_rigid = rigidSurfaceOf(m_model);
        m_near = std::make_unique<NearPairs>(std::shared_ptr<const BallTree>(m_soft, &m_soft->tree),
                                             std::shared_ptr<const BallTree>(m_rigid, &m_rigid->tree));
    }
    return true;
}

bool SoftRigidPair::readPositions(const btSoftBody& soft, const btTransform& from, const btTransform& to,
                                  btScalar timeStep, SoftWorld world) {
    if (world == SoftWorld::velocities) {
        return deformedPositionsOf(soft, *m_soft, 0, from, m_before) &&
               deformedPositionsOf(soft, *m_soft, timeStep, to, m_after);
    }
    return positionsOf(soft, *m_soft, from, to, m_before, m_after);
}

/// Somebody has put a body elsewhere: what it passed on that way is of no concern.
void SoftRigidPair::forgetIfMoved() {
    const float way = longestWay(m_before, m_after);
    if (m_last.size() != m_before.size() ||
        longestWay(m_last, m_before) > 4 * (way + m_usualWay) + 0.5F * m_soft->meanEdge) {
        m_sides.clear();
        m_last = m_before;
    }
    m_usualWay = way;
}

namespace {

float farthestOf(std::span<const Eigen::Vector3f> positions) {
    float most = 0;
    for (const Eigen::Vector3f& p : positions) {
        most = std::max(most, p.squaredNorm());
    }
    return std::sqrt(most);
}

}  // namespace

void SoftRigidPair::holdNodes(const btSoftBody& soft, const btTransform& from, const btTransform& to, float distance) {
    const btTransform stillInEnd = to.inverseTimes(from);
    // x - still = (1 - turn) x - shift, and |1 - turn| is at most the root of its entries' squares.
    btScalar turned = 0;
    for (int row = 0; row < 3; ++row) {
        turned += (stillInEnd.getBasis()[row] - btMatrix3x3::getIdentity()[row]).length2();
    }
    const auto farthest = static_cast<btScalar>(farthestOf(m_before));
    if (btSqrt(turned) * farthest + stillInEnd.getOrigin().length() <= static_cast<btScalar>(distance)) {
        return;
    }
    std::vector<float> pulls;
    for (std::size_t i = 0; i < m_held.size(); ++i) {
        const Eigen::Vector3f still = toEigen(stillInEnd * toBullet(m_before[i]));
        const Eigen::Vector3f body = m_before[i] - still;  // its way there
        const float way = body.norm();
        if (way > distance) {
            if (pulls.empty()) {
                pulls = pullsOf(soft, m_held.size());
            }
            const float outOfTheWay = std::clamp((m_after[i] - still).dot(body) / way, 0.0F, way);
            m_held[i] -= std::min(2 * pulls[i], outOfTheWay) / way * body;
        }
    }
}

SoftPairResult SoftRigidPair::process(btSoftBody& soft, const btCollisionObjectWrapper& rigid, btScalar timeStep,
                                      std::uint64_t look, std::uint64_t key, const Budget& budget) {
    SoftPairResult result;
    m_contacts.clear();
    const btCollisionObject& object = *rigid.getCollisionObject();
    const SoftWorld world = rigidWorldOf(soft);
    try {
        if (!findSurfaces(soft, *rigid.getCollisionShape(), look, result.refusal)) {
            forget();
            return result;
        }
    } catch (const Error& error) {
        result.refusal = error.what();
        forget();
        return result;
    }
    const btTransform end = endOf(object, timeStep);
    const btTransform frame = end * object.getWorldTransform().inverseTimes(rigid.getWorldTransform());
    if (!readPositions(soft, rigid.getWorldTransform(), frame, timeStep, world)) {
        result.refusal = "a node's position is no number";
        forget();
        return result;
    }
    forgetIfMoved();
    m_object = &object;
    m_frame = frame.getBasis();
    const Eigen::Vector3f* rest = m_rigid->tree.surface.rest.data();
    const std::span<const Eigen::Vector3f> still(rest, m_rigid->tree.surface.rest.size());
    const auto distance = static_cast<float>(soft.getCollisionShape()->getMargin() + marginOf(*m_shape));
    m_held = m_after;
    if (world == SoftWorld::positions) {
        holdNodes(soft, rigid.getWorldTransform(), frame, distance);
    }
    SurfaceInStep a{m_last, m_before, m_held, m_soft->triangles(), &m_soft->owners, &m_soft->tree.surface};
    a.solid = m_soft->solid;
    a.thread = m_soft->thread;
    SurfaceInStep b{still, still, still, m_rigid->tree.surface.triangles, &m_rigid->owners, &m_rigid->tree.surface};
    b.rigid = true;
    b.solid = m_rigid->solid;
    NearSettings settings;
    settings.distance = distance;
    settings.spacing = 0.5F * m_soft->meanEdge;
    settings.seed = m_context.settings.seed;
    settings.pair = key;
    settings.budget = budget;
    result.near = m_near->find(a, b, settings, m_pairs);
    if (result.near.stop == StopReason::invalidInput) {
        result.refusal = "a position is no number";
        forget();
        return result;
    }
    m_sides.find(a, b, m_pairs, static_cast<double>(settings.distance), nullptr, m_contacts);
    result.pairs = m_pairs.size();
    const RigidWay way{rigid.getWorldTransform(), frame, distance};
    const btScalar share = shareOfWay(way, b, m_contacts);
    for (SoftSurfaceContact& contact : m_contacts) {
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t v = contact.a[static_cast<std::size_t>(i)];
            contact.after += contact.weightsA[i] * (m_after[v] - m_held[v]).dot(contact.normal);
        }
    }
    result.contacts = write(soft, rigid, frame, end.getOrigin(), distance, world);
    for (const SoftSurfaceContact& contact : m_contacts) {
        result.crossings += contact.crossing ? 1 : 0;
        result.deepest = std::max(result.deepest, distance - contact.before);
    }
    m_last.swap(m_before);
    if (world == SoftWorld::positions && result.contacts > 0) {
        slowDown(object, share);
    }
    return result;
}

int SoftRigidPair::write(btSoftBody& soft, const btCollisionObjectWrapper& rigid, const btTransform& frame,
                         const btVector3& origin, float distance, SoftWorld world) {
    const btCollisionObject& object = *rigid.getCollisionObject();
    if (!m_contacts.empty() && !soft.isActive()) {
        // Its solver sleeps and would not clear them.
        if (object.isActive() && !object.isStaticObject()) {
            soft.activate();
        }
        return 0;
    }
    const RigidContactSite site{soft, object, frame, origin};
    int written = 0;
    if (world == SoftWorld::velocities) {
        using Flags = btSoftBody::fCollision;
        const bool link = object.getInternalType() == btCollisionObject::CO_FEATHERSTONE_LINK;
        const int flags = soft.m_cfg.collisions;
        const bool nodes = (flags & Flags::SDF_RDN) != 0;
        const bool faces = (flags & (link ? Flags::SDF_MDF : Flags::SDF_RDF)) != 0;
        for (const SoftSurfaceContact& contact : m_contacts) {
            const bool wanted = contact.features == Features::cornerFace ? nodes : faces;
            written += wanted && writeDeformableContact(site, *m_softEntry, contact, distance) ? 1 : 0;
        }
        return written;
    }
    if (!object.hasContactResponse()) {
        return 0;
    }
    const MovableBodies movable{&soft, nullptr, m_soft->thread, false};
    const auto hardness = static_cast<double>(object.isStaticOrKinematicObject() ? soft.m_cfg.kKHR : soft.m_cfg.kCHR);
    const std::vector<Eigen::Vector3f> before = m_before;
    bringBack({movable, static_cast<double>(distance), hardness, frame.getBasis()}, soft, nullptr, &m_before, nullptr,
              m_contacts);
    for (std::size_t i = 0; i < before.size(); ++i) {
        m_after[i] += m_before[i] - before[i];
    }
    return writeStops(site, distance, movable);
}

int SoftRigidPair::writeStops(const RigidContactSite& site, float distance, const MovableBodies& movable) {
    std::vector<double> missing;
    for (const SoftSurfaceContact& contact : m_contacts) {
        missing.push_back(static_cast<double>(std::min(distance, contact.before) - contact.after));
    }
    const NodeMoves moves = nodeMoves(movable, m_contacts, missing);
    // A body that moves takes what it meets along; the gap that it has to close on the way is none of the solver's, or
    // it would draw both together.
    const double most = site.rigid.isStaticObject() ? 1e9 : static_cast<double>(distance);
    int written = 0;
    for (const NodeMove& move : moves[0]) {
        NodeStop stop;
        stop.node = move.node;
        stop.normal = move.move.normalized();
        stop.place = m_after[move.node].cast<double>() + move.move;
        const double nearer = stop.normal.dot(m_before[move.node].cast<double>() - stop.place);
        stop.approach = std::clamp(nearer, 0.0, most);
        written += writeRigidContact(site, stop) ? 1 : 0;
    }
    // What moves away by itself may be drawn back by its links.
    std::vector<std::pair<std::uint32_t, std::size_t>> guarded;
    for (std::size_t c = 0; c < m_contacts.size(); ++c) {
        const SoftSurfaceContact& contact = m_contacts[c];
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t node = contact.a[static_cast<std::size_t>(i)];
            if (contact.before < distance && contact.weightsA[i] > 0.1F && moveOf(moves[0], node) == nullptr) {
                guarded.emplace_back(node, c);
            }
        }
    }
    std::ranges::sort(guarded, {}, [&](const auto& guard) {
        return std::tuple(guard.first, m_contacts[guard.second].after, guard.second);
    });
    const auto repeated = std::ranges::unique(guarded, {}, [](const auto& guard) { return guard.first; });
    guarded.erase(repeated.begin(), repeated.end());
    for (const auto& [node, c] : guarded) {
        NodeStop stop;
        stop.node = node;
        stop.normal = m_contacts[c].normal.cast<double>();
        stop.place = m_before[node].cast<double>();
        written += writeRigidContact(site, stop) ? 1 : 0;
    }
    return written;
}

void SoftRigidPair::appendContacts(const btSoftBody& body, std::vector<SoftContact>& contacts) const {
    if (m_body != &body) {
        return;
    }
    for (const SoftSurfaceContact& contact : m_contacts) {
        SoftContact told = toldOf(contact.a, contact.weightsA, m_soft->nodes);
        told.other = m_object;
        told.triangle = static_cast<int>(contact.pair.triangleB);
        told.normal = toEigen(m_frame * toBullet(contact.normal));
        told.distance = contact.before;
        told.predicted = contact.after;
        told.passing = contact.crossing;
        contacts.push_back(told);
    }
}

SoftContact toldOf(const std::array<std::uint32_t, 3>& vertices, const Eigen::Vector3f& weights, std::uint32_t nodes) {
    SoftContact told;
    for (std::size_t i = 0; i < 3; ++i) {
        const float weight = weights[static_cast<int>(i)];
        told.nodes[i] = weight > 0 && vertices[i] < nodes ? static_cast<int>(vertices[i]) : -1;
        told.weights[i] = weight;
    }
    return told;
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
