#include <grapeshot/plugin/soft_contacts.hpp>

#include <BulletSoftBody/btSoftBody.h>

#include <algorithm>
#include <cmath>

#include <grapeshot/core/error.hpp>
#include <grapeshot/plugin/detail/closest_convex.hpp>
#include <grapeshot/plugin/detail/context.hpp>
#include <grapeshot/plugin/detail/convert.hpp>
#include <grapeshot/plugin/detail/leaf_shapes.hpp>
#include <grapeshot/plugin/detail/rigid_surface.hpp>
#include <grapeshot/plugin/detail/shape_kind.hpp>
#include <grapeshot/plugin/detail/soft_pair.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

using detail::Context;
using detail::Contexts;

Status addSelfCollision(btCollisionDispatcher* dispatcher, btSoftBody* body, const SelfCollision& how) noexcept {
    if (dispatcher == nullptr || body == nullptr) {
        return Status::nullPointer;
    }
    for (const float length : {how.thickness, how.exclusion, how.spacing}) {
        if (!(length >= 0 && std::isfinite(length))) {
            return Status::badArgument;
        }
    }
    const std::shared_ptr<Context> context = Contexts::instance().find(dispatcher);
    if (!context || !context->isIn(*dispatcher)) {
        return Status::notRegistered;
    }
    try {
        context->softLoop.add(*context, *body, how);
        return Status::ok;
    } catch (...) {
        return Status::outOfMemory;
    }
}

Status removeSelfCollision(btCollisionDispatcher* dispatcher, const btSoftBody* body) noexcept {
    const std::shared_ptr<Context> context = Contexts::instance().find(dispatcher);
    if (!context) {
        return Status::notRegistered;
    }
    return context->softLoop.remove(body) ? Status::ok : Status::badArgument;
}

std::vector<SoftContact> contactsOf(const btCollisionDispatcher* dispatcher, const btSoftBody* body) noexcept {
    std::vector<SoftContact> contacts;
    const std::shared_ptr<Context> context = Contexts::instance().find(dispatcher);
    if (!context || body == nullptr) {
        return contacts;
    }
    try {
        for (const detail::SoftPair* pair : context->softLoop.pairs()) {
            pair->appendContacts(*body, contacts);
        }
        context->softLoop.appendContacts(*body, contacts);
    } catch (...) {
        contacts.clear();
    }
    return contacts;
}

namespace {

/// Looks farther and farther, until something is there.
void search(const detail::SoftSurface& soft, const SurfaceState& state, const BallTree& other,
            const SurfaceState& otherState, float maxDistance, const btTransform& frame, ClosestFeatures& best) {
    Tracker tracker(soft.tree, other);
    TrackSettings settings;
    settings.mode = TrackMode::exact;
    const float limit = best.found ? std::min(maxDistance, best.distance) : maxDistance;
    for (float distance = std::min(limit, 0.25F * soft.meanEdge + 1e-6F);; distance = std::min(limit, 2 * distance)) {
        settings.maxDistance = distance;
        const TrackResult result = tracker.step(state, otherState, settings);
        for (const TrackedContact& contact : result.contacts) {
            const float found = std::max(0.0F, contact.signedDistance);
            if (best.found && found >= best.distance) {
                continue;
            }
            best.found = true;
            best.distance = found;
            const Triangle& t = soft.triangles()[contact.pair.triangleA];
            for (std::size_t i = 0; i < 3; ++i) {
                best.nodes[i] = t[i] < soft.nodes ? static_cast<int>(t[i]) : -1;
            }
            best.triangle = static_cast<int>(contact.pair.triangleB);
            best.onSoft = detail::toEigen(frame * detail::toBullet(contact.onA));
            best.onOther = detail::toEigen(frame * detail::toBullet(contact.onB));
        }
        if (!result.contacts.empty() || distance >= limit || result.stop == StopReason::invalidInput) {
            return;
        }
    }
}

void searchConvex(const detail::SoftSurface& soft, std::span<const Eigen::Vector3f> positions,
                  const btConvexShape& convex, const btTransform& pose, float maxDistance, ClosestFeatures& best) {
    const float limit = best.found ? std::min(maxDistance, best.distance) : maxDistance;
    const detail::ClosestToConvex closest = detail::closestToConvex(positions, soft.triangles(), convex, pose, limit);
    if (!closest.found || (best.found && closest.distance >= best.distance)) {
        return;
    }
    best.found = true;
    best.distance = closest.distance;
    const Triangle& t = soft.triangles()[closest.triangle];
    for (std::size_t i = 0; i < 3; ++i) {
        best.nodes[i] = t[i] < soft.nodes ? static_cast<int>(t[i]) : -1;
    }
    best.triangle = -1;
    best.onSoft = closest.onSurface;
    best.onOther = closest.onConvex;
}

bool currentPositions(const btSoftBody& body, const detail::SoftSurface& surface, const btTransform& frame,
                      std::vector<Eigen::Vector3f>& positions) {
    return detail::positionsOf(body, surface, detail::NodePart::after, frame, positions);
}

}  // namespace

ClosestFeatures closestFeatures(const btSoftBody& soft, const btCollisionObject& other, float maxDistance) noexcept {
    ClosestFeatures best;
    if (!(maxDistance > 0 && std::isfinite(maxDistance)) || &other == &soft) {
        return best;
    }
    try {
        detail::SoftEntry entry;
        const auto surface = entry.surface(soft, 0);
        best.status = Status::unusableMesh;
        if (!surface) {
            return best;
        }
        std::vector<Eigen::Vector3f> positions;
        if (const btSoftBody* second = btSoftBody::upcast(&other)) {
            detail::SoftEntry secondEntry;
            const auto secondSurface = secondEntry.surface(*second, 0);
            const btTransform frame(btMatrix3x3::getIdentity(), soft.m_nodes[0].m_x);
            std::vector<Eigen::Vector3f> secondPositions;
            if (secondSurface && currentPositions(soft, *surface, frame, positions) &&
                currentPositions(*second, *secondSurface, frame, secondPositions)) {
                best.status = Status::ok;
                search(*surface, {positions, {}, Stretch::measured(), {}}, secondSurface->tree,
                       {secondPositions, {}, Stretch::measured(), {}}, maxDistance, frame, best);
            }
            return best;
        }
        best.status = Status::unsupportedShape;
        std::vector<detail::PlacedShape> leaves;
        detail::appendLeaves(*other.getCollisionShape(), btTransform::getIdentity(), leaves);
        for (const detail::PlacedShape& leaf : leaves) {
            if (leaf.shape->isConvex()) {
                if (!currentPositions(soft, *surface, btTransform::getIdentity(), positions)) {
                    best.status = Status::unusableMesh;
                    return best;
                }
                best.status = Status::ok;
                searchConvex(*surface, positions, static_cast<const btConvexShape&>(*leaf.shape),
                             other.getWorldTransform() * leaf.inBody, maxDistance, best);
                continue;
            }
            if (!detail::isMesh(*leaf.shape)) {
                continue;
            }
            const auto shapeEntry = detail::ShapeModels::instance().entry(*leaf.shape);
            const auto model =
                shapeEntry->model(*leaf.shape, detail::ShapeModels::instance().cache(), detail::Check::thorough, 0);
            const btTransform frame = other.getWorldTransform() * leaf.inBody;
            if (!model->mesh || !currentPositions(soft, *surface, frame, positions)) {
                best.status = Status::unusableMesh;
                return best;
            }
            best.status = Status::ok;
            const auto rigid = detail::rigidSurfaceOf(model);
            search(*surface, {positions, {}, Stretch::measured(), {}}, rigid->tree, rigidState(), maxDistance, frame,
                   best);
        }
    } catch (const Error&) {
        best.status = Status::unusableMesh;
    } catch (...) {
        best.status = Status::outOfMemory;
    }
    return best;
}

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
