#include <grapeshot/plugin/detail/compound_algorithm.hpp>

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btCompoundCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <LinearMath/btAabbUtil2.h>

#include <algorithm>
#include <array>
#include <vector>

#include <grapeshot/plugin/detail/child_in_place.hpp>
#include <grapeshot/plugin/detail/context.hpp>
#include <grapeshot/plugin/detail/pair_motion.hpp>
#include <grapeshot/plugin/detail/shape_kind.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

struct Box {
    btVector3 lower, upper;
    explicit Box(const btCollisionObjectWrapper& wrap) {
        wrap.getCollisionShape()->getAabb(wrap.getWorldTransform(), lower, upper);
    }
    [[nodiscard]] btScalar radius() const { return (upper - lower).length() / 2; }
};

}  // namespace

class ChildPairs {
  public:
    ChildPairs(const btCollisionAlgorithmConstructionInfo& info, std::shared_ptr<Context> context, bool query)
        : m_dispatcher(*info.m_dispatcher1), m_context(std::move(context)), m_shared(info.m_manifold), m_query(query) {}
    ~ChildPairs() { clear(); }
    ChildPairs(const ChildPairs&) = delete;
    ChildPairs& operator=(const ChildPairs&) = delete;

    void process(const btCollisionObjectWrapper& body0, const btCollisionObjectWrapper& body1,
                 const btDispatcherInfo& info, btManifoldResult& result) {
        const std::array bodies{&body0, &body1};
        const std::size_t compound = isGImpactCompound(*body0.getCollisionShape()) ? 0 : 1;
        bind(*bodies[compound]->getCollisionShape(), *bodies[1 - compound]->getCollisionShape());
        m_processing = true;  // nothing below throws
        for (std::size_t i = 0; i < m_children.size() && !m_closed; ++i) {
            processChild(i, bodies, compound, info, result);
        }
        m_processing = false;
        if (m_closed) {
            clear();
        }
    }

    /// At once or, from within a callback of the program's that `process` has called, when that returns.
    void close() {
        m_closed = true;
        if (!m_processing) {
            clear();
        }
    }

    void collectManifolds(btManifoldArray& manifolds) const {
        for (const Child& child : m_children) {
            if (child.algorithm != nullptr) {
                child.algorithm->getAllContactManifolds(manifolds);
            }
        }
    }

  private:
    struct Child {
        const btCollisionShape* shape = nullptr;
        int type = -1;
        btTransform inBody = btTransform::getIdentity();
        btCollisionAlgorithm* algorithm = nullptr;
    };

    /// The program may have put other shapes on the bodies, also one that is no compound: then it is its only child.
    void bind(const btCollisionShape& compound, const btCollisionShape& other) {
        if (m_other != &other || m_otherType != other.getShapeType()) {
            clear();
            m_other = &other;
            m_otherType = other.getShapeType();
        }
        const btGImpactShapeInterface* children =
            isGImpactCompound(compound) ? static_cast<const btGImpactShapeInterface*>(&compound) : nullptr;
        const auto count = children != nullptr ? static_cast<std::size_t>(children->getNumChildShapes()) : 1;
        for (std::size_t i = count; i < m_children.size(); ++i) {
            drop(m_children[i]);
        }
        m_children.resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            Child& child = m_children[i];
            const auto index = static_cast<int>(i);
            const btCollisionShape* shape = children != nullptr ? children->getChildShape(index) : &compound;
            if (child.shape != shape || child.type != shape->getShapeType()) {
                drop(child);
                child.shape = shape;
                child.type = shape->getShapeType();
            }
            child.inBody = children != nullptr && children->childrenHasTransform() ? children->getChildTransform(index)
                                                                                   : btTransform::getIdentity();
        }
    }

    void processChild(std::size_t index, const std::array<const btCollisionObjectWrapper*, 2>& bodies,
                      std::size_t compound, const btDispatcherInfo& info, btManifoldResult& result) {
        Child& child = m_children[index];
        const btCollisionObjectWrapper& body = *bodies[compound];
        const btCollisionObjectWrapper& other = *bodies[1 - compound];
        const btTransform pose = body.getWorldTransform() * child.inBody;
        const btCollisionObjectWrapper wrap(&body, child.shape, body.getCollisionObject(), pose, -1,
                                            static_cast<int>(index));
        const bool wanted = gCompoundChildShapePairCallback == nullptr ||
                            gCompoundChildShapePairCallback(other.getCollisionShape(), child.shape);
        if (!wanted || !meet(wrap, other, info, result)) {
            drop(child);
            return;
        }
        auto ordered = bodies;
        ordered[compound] = &wrap;
        if (child.algorithm == nullptr) {
            child.algorithm = m_dispatcher.findAlgorithm(
                ordered[0], ordered[1], m_shared, m_query ? BT_CLOSEST_POINT_ALGORITHMS : BT_CONTACT_POINT_ALGORITHMS);
        }
        if (child.algorithm != nullptr) {
            const ChildInPlace inPlace(result, wrap);
            child.algorithm->processCollision(ordered[0], ordered[1], info, &result);
        }
    }

    /// Within this step, or within the distance that a query asks for.
    [[nodiscard]] bool meet(const btCollisionObjectWrapper& child, const btCollisionObjectWrapper& other,
                            const btDispatcherInfo& info, const btManifoldResult& result) const {
        const Box box0(child);
        const Box box1(other);
        btScalar reach = gContactBreakingThreshold + result.m_closestPointDistanceThreshold;
        if (!m_query && m_context->settings.speculative && info.m_timeStep > 0) {
            const btScalar motion = approachBound(child, box0.radius(), other, box1.radius(), info.m_timeStep);
            reach += btMin(motion, btScalar(m_context->settings.speculativeLimit));
        }
        const btVector3 around(reach, reach, reach);
        return TestAabbAgainstAabb2(box0.lower - around, box0.upper + around, box1.lower, box1.upper);
    }

    void drop(Child& child) {
        if (child.algorithm != nullptr) {
            child.algorithm->~btCollisionAlgorithm();
            m_dispatcher.freeCollisionAlgorithm(child.algorithm);
            child.algorithm = nullptr;
        }
    }

    void clear() {
        for (Child& child : m_children) {
            drop(child);
        }
        m_children.clear();
    }

    btDispatcher& m_dispatcher;
    std::shared_ptr<Context> m_context;
    btPersistentManifold* m_shared;
    bool m_query;
    const btCollisionShape* m_other = nullptr;
    int m_otherType = -1;
    std::vector<Child> m_children;
    bool m_processing = false;
    bool m_closed = false;
};

CompoundAlgorithm::CompoundAlgorithm(const btCollisionAlgorithmConstructionInfo& info, std::shared_ptr<Context> context,
                                     bool query)
    : btActivatingCollisionAlgorithm(info), m_pairs(std::make_shared<ChildPairs>(info, std::move(context), query)) {}

CompoundAlgorithm::~CompoundAlgorithm() {
    m_pairs->close();
}

void CompoundAlgorithm::processCollision(const btCollisionObjectWrapper* body0, const btCollisionObjectWrapper* body1,
                                         const btDispatcherInfo& info, btManifoldResult* result) noexcept {
    // A callback of the program's may remove a body, and with it this algorithm.
    const std::shared_ptr<ChildPairs> pairs = m_pairs;
    try {
        pairs->process(*body0, *body1, info, *result);
    } catch (...) {
        // Out of memory for the list of children: the next step tries again.
    }
}

void CompoundAlgorithm::getAllContactManifolds(btManifoldArray& manifolds) noexcept {
    m_pairs->collectManifolds(manifolds);
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
