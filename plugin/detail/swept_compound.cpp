#include <grapeshot/plugin/detail/swept_compound.hpp>

#include <BulletCollision/CollisionDispatch/btCompoundCollisionAlgorithm.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <LinearMath/btAabbUtil2.h>

#include <algorithm>
#include <array>
#include <new>
#include <utility>
#include <vector>

#include <grapeshot/plugin/detail/child_in_place.hpp>
#include <grapeshot/plugin/detail/context.hpp>
#include <grapeshot/plugin/detail/pair_motion.hpp>
#include <grapeshot/plugin/detail/shape_kind.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

/// A shape at its place, its box, and the way to it through the compounds.
struct Part {
    const btCollisionObjectWrapper* wrap = nullptr;
    btVector3 lower, upper;
    std::uint64_t path = 0;

    Part(const btCollisionObjectWrapper& part, std::uint64_t way) : wrap(&part), path(way) {
        part.getCollisionShape()->getAabb(part.getWorldTransform(), lower, upper);
    }
    /// About its own origin, m.
    [[nodiscard]] btScalar radius() const {
        const btVector3& origin = wrap->getWorldTransform().getOrigin();
        btVector3 farthest = (upper - origin).absolute();
        farthest.setMax((lower - origin).absolute());
        return farthest.length();
    }
};

const btCompoundShape* compoundOf(const Part& part) {
    const btCollisionShape* shape = part.wrap->getCollisionShape();
    return shape->getShapeType() == COMPOUND_SHAPE_PROXYTYPE ? static_cast<const btCompoundShape*>(shape) : nullptr;
}

/// Is the shape a mesh of ours, or a compound with one in it?
bool hasMesh(const btCollisionShape& shape) {
    if (shape.getShapeType() != COMPOUND_SHAPE_PROXYTYPE) {
        return isMesh(shape);
    }
    const auto& compound = static_cast<const btCompoundShape&>(shape);
    for (int i = 0; i < compound.getNumChildShapes(); ++i) {
        if (hasMesh(*compound.getChildShape(i))) {
            return true;
        }
    }
    return false;
}

}  // namespace

class ChildrenAhead {
  public:
    ChildrenAhead(btDispatcher& dispatcher, std::shared_ptr<Context> context)
        : m_dispatcher(dispatcher), m_context(std::move(context)) {}
    ~ChildrenAhead() { clear(); }
    ChildrenAhead(const ChildrenAhead&) = delete;
    ChildrenAhead& operator=(const ChildrenAhead&) = delete;

    void own(btCollisionAlgorithm* recursion) { m_recursion = recursion; }

    void process(const btCollisionObjectWrapper& body0, const btCollisionObjectWrapper& body1,
                 const btDispatcherInfo& info, btManifoldResult& result) {
        m_processing = true;
        m_recursion->processCollision(&body0, &body1, info, &result);
        for (Child& child : m_children) {
            child.used = false;
        }
        m_info = &info;
        m_result = &result;
        try {
            lookAhead(Part(body0, 1), Part(body1, 1));
        } catch (...) {
            // Out of memory: the next step tries again.
        }
        dropUnused();
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
        if (m_recursion != nullptr) {
            m_recursion->getAllContactManifolds(manifolds);
        }
        for (const Child& child : m_children) {
            child.algorithm->getAllContactManifolds(manifolds);
        }
    }

  private:
    /// Two leaf children that may meet in this step.
    struct Child {
        std::array<std::uint64_t, 2> paths{};
        btCollisionAlgorithm* algorithm = nullptr;
        bool used = false;
    };

    /// What the two may come nearer to each other by in the step and still be looked at, m.
    [[nodiscard]] btScalar reachOf(const Part& part0, const Part& part1) const {
        const btScalar motion =
            approachBound(*part0.wrap, part0.radius(), *part1.wrap, part1.radius(), m_info->m_timeStep);
        return btMin(motion, btScalar(m_context->settings.speculativeLimit));
    }

    /// Goes down into compounds as far as boxes come together within the step.
    void lookAhead(const Part& part0, const Part& part1) {
        if (m_closed || !m_context->settings.speculative || !(m_info->m_timeStep > 0)) {
            return;
        }
        const btScalar reach = reachOf(part0, part1);
        if (!(reach > gContactBreakingThreshold)) {
            return;  // slow: Bullet's recursion is in time
        }
        const btVector3 around(reach, reach, reach);
        if (!TestAabbAgainstAabb2(part0.lower - around, part0.upper + around, part1.lower, part1.upper)) {
            return;
        }
        const btCompoundShape* compound0 = compoundOf(part0);
        const btCompoundShape* compound1 = compoundOf(part1);
        if (compound0 != nullptr || compound1 != nullptr) {
            const bool first = compound0 != nullptr;
            const Part& compound = first ? part0 : part1;
            const Part& other = first ? part1 : part0;
            forEachChild(first ? *compound0 : *compound1, compound, other,
                         [&](const Part& child) { first ? lookAhead(child, other) : lookAhead(other, child); });
        } else if (!TestAabbAgainstAabb2(part0.lower, part0.upper, part1.lower, part1.upper)) {
            processAhead(part0, part1);
        }
    }

    template <class Use>
    void forEachChild(const btCompoundShape& shape, const Part& compound, const Part& other, Use&& use) {
        for (int i = 0; i < shape.getNumChildShapes() && !m_closed; ++i) {
            const btCollisionShape* child = shape.getChildShape(i);
            if (gCompoundChildShapePairCallback != nullptr &&
                !gCompoundChildShapePairCallback(other.wrap->getCollisionShape(), child)) {
                continue;
            }
            const btTransform pose = compound.wrap->getWorldTransform() * shape.getChildTransform(i);
            const btCollisionObjectWrapper wrap(compound.wrap, child, compound.wrap->getCollisionObject(), pose, -1, i);
            use(Part(wrap, compound.path * 1000003U + static_cast<std::uint64_t>(i) + 1));
        }
    }

    void processAhead(const Part& part0, const Part& part1) {
        const PairKind kind =
            kindOf(*part0.wrap->getCollisionShape(), *part1.wrap->getCollisionShape(), m_context->settings);
        if (kind == PairKind::foreign) {
            return;
        }
        const std::array paths{part0.path, part1.path};
        auto known = std::ranges::find(m_children, paths, &Child::paths);
        if (known == m_children.end()) {
            m_children.reserve(m_children.size() + 1);  // before there is something to lose
            btCollisionAlgorithm* made =
                m_dispatcher.findAlgorithm(part0.wrap, part1.wrap, nullptr, BT_CONTACT_POINT_ALGORITHMS);
            if (made == nullptr) {
                return;
            }
            m_children.push_back({paths, made, true});
            known = m_children.end() - 1;
        }
        known->used = true;
        const WrapInPlace first(*m_result, *part0.wrap, isFirst(*part0.wrap));
        const WrapInPlace second(*m_result, *part1.wrap, isFirst(*part1.wrap));
        nameChild(*part0.wrap);
        nameChild(*part1.wrap);
        known->algorithm->processCollision(part0.wrap, part1.wrap, *m_info, m_result);
    }

    [[nodiscard]] bool isFirst(const btCollisionObjectWrapper& wrap) const {
        return m_result->getBody0Internal() == wrap.getCollisionObject();
    }
    void nameChild(const btCollisionObjectWrapper& wrap) {
        if (wrap.m_parent != nullptr) {
            isFirst(wrap) ? m_result->setShapeIdentifiersA(-1, wrap.m_index)
                          : m_result->setShapeIdentifiersB(-1, wrap.m_index);
        }
    }

    void destroy(btCollisionAlgorithm* algorithm) {
        algorithm->~btCollisionAlgorithm();
        m_dispatcher.freeCollisionAlgorithm(algorithm);
    }
    void dropUnused() {
        const auto isUnused = [](const Child& child) { return !child.used; };
        for (auto found = std::ranges::find_if(m_children, isUnused); found != m_children.end();
             found = std::ranges::find_if(m_children, isUnused)) {
            btCollisionAlgorithm* algorithm = found->algorithm;
            m_children.erase(found);
            destroy(algorithm);  // which may call the program
        }
    }
    void clear() {
        for (const Child& child : std::exchange(m_children, {})) {
            destroy(child.algorithm);
        }
        if (m_recursion != nullptr) {
            destroy(std::exchange(m_recursion, nullptr));
        }
    }

    btDispatcher& m_dispatcher;
    std::shared_ptr<Context> m_context;
    btCollisionAlgorithm* m_recursion = nullptr;
    std::vector<Child> m_children;
    const btDispatcherInfo* m_info = nullptr;  // of the step
    btManifoldResult* m_result = nullptr;
    bool m_processing = false;
    bool m_closed = false;
};

btCollisionAlgorithm* SweptCompoundAlgorithm::CreateFunc::CreateCollisionAlgorithm(
    btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* body0,
    const btCollisionObjectWrapper* body1) {
    btCollisionAlgorithm* recursion = m_context.createPrevious(info, *body0, *body1);
    if (recursion == nullptr || info.m_manifold != nullptr || !m_context.settings.speculative ||
        !(hasMesh(*body0->getCollisionShape()) || hasMesh(*body1->getCollisionShape()))) {
        return recursion;
    }
    void* place = info.m_dispatcher1->allocateCollisionAlgorithm(static_cast<int>(sizeof(SweptCompoundAlgorithm)));
    try {
        return new (place) SweptCompoundAlgorithm(info, m_context.shared_from_this(), recursion);
    } catch (...) {
        info.m_dispatcher1->freeCollisionAlgorithm(place);
        return recursion;
    }
}

SweptCompoundAlgorithm::SweptCompoundAlgorithm(const btCollisionAlgorithmConstructionInfo& info,
                                               std::shared_ptr<Context> context, btCollisionAlgorithm* recursion)
    : btActivatingCollisionAlgorithm(info),
      m_children(std::make_shared<ChildrenAhead>(*info.m_dispatcher1, std::move(context))) {
    m_children->own(recursion);
}

SweptCompoundAlgorithm::~SweptCompoundAlgorithm() {
    m_children->close();
}

void SweptCompoundAlgorithm::processCollision(const btCollisionObjectWrapper* body0,
                                              const btCollisionObjectWrapper* body1, const btDispatcherInfo& info,
                                              btManifoldResult* result) {
    // A callback of the program's may remove a body, and with it this algorithm.
    const std::shared_ptr<ChildrenAhead> children = m_children;
    children->process(*body0, *body1, info, *result);
}

void SweptCompoundAlgorithm::getAllContactManifolds(btManifoldArray& manifolds) {
    m_children->collectManifolds(manifolds);
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
