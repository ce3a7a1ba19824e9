// Poses, velocities and inertia.
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <limits>

#include <grapeshot/plugin/detail/convert.hpp>
#include <grapeshot/plugin/detail/diagnosis_parts.hpp>
#include <grapeshot/plugin/detail/shape_kind.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

bool isFinitePose(const btTransform& pose) {
    return isFinite(pose.getOrigin()) && isFinite(pose.getBasis()[0]) && isFinite(pose.getBasis()[1]) &&
           isFinite(pose.getBasis()[2]);
}

/// Half of the distance between neighbouring numbers of that size.
double rounding(const btVector3& v) {
    const btScalar largest = v.absolute()[v.absolute().maxAxis()];
    return static_cast<double>(largest) * static_cast<double>(std::numeric_limits<btScalar>::epsilon()) / 2;
}

class BodyFinder {
  public:
    explicit BodyFinder(std::vector<Finding>& findings) : m_findings(findings) {}

    void lookAt(const Patient::Body& body, int index) {
        m_index = index;
        const btTransform& pose = body.object->getWorldTransform();
        const btRigidBody* rigid = btRigidBody::upcast(body.object);
        if (!isFinitePose(pose) ||
            (rigid != nullptr && (!isFinite(rigid->getLinearVelocity()) || !isFinite(rigid->getAngularVelocity())))) {
            add(FindingCode::notFinite, Severity::error, 0,
                "Its pose or velocity is no number, or too large for single precision: its pairs are refused. Remove "
                "it, or set both anew.");
            return;
        }
        if (!isRigid({toEigen(pose.getBasis()), Eigen::Vector3f::Zero()})) {
            add(FindingCode::notRigid, Severity::error, 0,
                "Its rotation is no rotation: its pairs are refused. Scale the shape (setLocalScaling), not the pose.");
        }
        const double off = rounding(pose.getOrigin());
        if (off > 0.01 * static_cast<double>(gContactBreakingThreshold)) {
            add(FindingCode::farFromOrigin, Severity::warning, off,
                "So far from the origin its pose is rounded to " + shortNumber(off) +
                    " m, and contacts flicker: move the origin, or use Bullet in double precision.");
        }
        if (rigid != nullptr && body.moves) {
            inertia(*rigid, body);
        }
    }

  private:
    void inertia(const btRigidBody& rigid, const Patient::Body& body) {
        const bool wantsToTurn = !rigid.getAngularFactor().isZero();
        const auto isMeshLeaf = [](const PlacedShape& leaf) { return isMesh(*leaf.shape); };
        if (wantsToTurn && rigid.getInvInertiaDiagLocal().isZero() &&
            std::any_of(body.leaves.begin(), body.leaves.end(), isMeshLeaf)) {
            add(FindingCode::noInertia, Severity::warning, 0,
                "A moving mesh without inertia cannot turn; btBvhTriangleMeshShape::calculateLocalInertia gives zero. "
                "Take grapeshot::massProperties.");
        }
    }

    void add(FindingCode code, Severity severity, double value, std::string message) {
        m_findings.push_back({code, severity, m_index, -1, nullptr, value, std::move(message)});
    }

    std::vector<Finding>& m_findings;
    int m_index = -1;
};

}  // namespace

void diagnoseBodies(const Patient& patient, std::vector<Finding>& findings) {
    BodyFinder finder(findings);
    for (std::size_t i = 0; i < patient.bodies.size(); ++i) {
        finder.lookAt(patient.bodies[i], static_cast<int>(i));
    }
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
