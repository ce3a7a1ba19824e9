#include <grapeshot/plugin/debug_draw.hpp>

#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <LinearMath/btIDebugDraw.h>

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <grapeshot/plugin/detail/context.hpp>
#include <grapeshot/plugin/detail/convert.hpp>
#include <grapeshot/plugin/detail/leaf_shapes.hpp>
#include <grapeshot/plugin/detail/pair_processor.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

namespace {

using detail::Context;
using detail::toBullet;

enum class Sureness { certain, estimated, refused };

Sureness surenessOf(bool certain, StopReason stop) {
    return stop == StopReason::invalidInput ? Sureness::refused : certain ? Sureness::certain : Sureness::estimated;
}

class Drawing {
  public:
    Drawing(btCollisionWorld& world, const Context& context, btIDebugDraw& drawer, const DebugDrawOptions& options)
        : m_world(world), m_context(context), m_drawer(drawer), m_options(options) {}

    void trees() {
        const btCollisionObjectArray& objects = m_world.getCollisionObjectArray();
        std::vector<detail::PlacedShape> leaves;
        for (int i = 0; i < objects.size(); ++i) {
            leaves.clear();
            detail::appendLeaves(*objects[i]->getCollisionShape(), objects[i]->getWorldTransform(), leaves);
            for (const detail::PlacedShape& leaf : leaves) {
                if (const auto model = detail::ShapeModels::instance().present(*leaf.shape, true);
                    model && model->mesh) {
                    tree(model->mesh->tree, leaf.inBody);
                }
            }
        }
    }

    void pairs() {
        std::map<std::pair<int, int>, Sureness> children;
        for (const PairStatistics& pair : m_context.statistics.pairs) {
            Sureness& worst = children.emplace(std::minmax(pair.proxyA, pair.proxyB), Sureness::certain).first->second;
            worst = std::max(worst, surenessOf(pair.certain, pair.stop));
        }
        const btBroadphasePairArray& all = m_world.getPairCache()->getOverlappingPairArray();
        for (int i = 0; i < all.size(); ++i) {
            const btBroadphasePair& pair = all[i];
            if (pair.m_algorithm == nullptr) {
                continue;
            }
            std::optional<Sureness> sureness;
            if (const auto* ours = dynamic_cast<const MeshCollisionAlgorithm*>(pair.m_algorithm)) {
                if (ours->processor() != nullptr && ours->processor()->isOf(m_context)) {
                    const PairResult& last = ours->processor()->share().result;
                    sureness = surenessOf(last.certain && !ours->processor()->standsIn(), last.stop);
                }
            } else if (const auto known =
                           children.find(std::minmax(pair.m_pProxy0->getUid(), pair.m_pProxy1->getUid()));
                       known != children.end()) {
                sureness = known->second;
            }
            if (sureness) {
                draw(pair, colorOf(*sureness));
            }
        }
    }

  private:
    [[nodiscard]] const btVector3& colorOf(Sureness sureness) const {
        return sureness == Sureness::certain     ? m_options.certainColor
               : sureness == Sureness::estimated ? m_options.estimatedColor
                                                 : m_options.refusedColor;
    }

    void tree(const Tree& tree, const btTransform& pose) {
        m_drawer.drawBox(toBullet(tree.lower), toBullet(tree.upper), pose, m_options.treeColor);
        std::vector<std::uint32_t> level{0};
        std::vector<std::uint32_t> next;
        for (int depth = 1; depth <= m_options.treeLevel && !level.empty() && !tree.nodes.empty(); ++depth) {
            next.clear();
            for (const std::uint32_t index : level) {
                const Node& node = tree.nodes[index];
                for (int slot = 0; slot < 4; ++slot) {
                    if (node.child[slot] == noChild) {
                        continue;
                    }
                    box(node, slot, pose);
                    if (!isLeaf(node.child[slot])) {
                        next.push_back(indexOf(node.child[slot]));
                    }
                }
            }
            level.swap(next);
        }
    }

    void box(const Node& node, int slot, const btTransform& pose) {
        const Eigen::Vector3f center(node.center[0][slot], node.center[1][slot], node.center[2][slot]);
        const Eigen::Vector3f half(node.half[0][slot], node.half[1][slot], node.half[2][slot]);
        m_drawer.drawBox(toBullet(center - half), toBullet(center + half), pose, m_options.treeColor);
    }

    void draw(const btBroadphasePair& pair, const btVector3& color) {
        if (m_options.pairs) {
            const auto originOf = [](const btBroadphaseProxy* proxy) {
                return static_cast<const btCollisionObject*>(proxy->m_clientObject)->getWorldTransform().getOrigin();
            };
            m_drawer.drawLine(originOf(pair.m_pProxy0), originOf(pair.m_pProxy1), color);
        }
        if (!m_options.contacts) {
            return;
        }
        btManifoldArray manifolds;
        pair.m_algorithm->getAllContactManifolds(manifolds);
        for (int m = 0; m < manifolds.size(); ++m) {
            for (int i = 0; i < manifolds[m]->getNumContacts(); ++i) {
                const btManifoldPoint& point = manifolds[m]->getContactPoint(i);
                m_drawer.drawContactPoint(point.m_positionWorldOnB, point.m_normalWorldOnB, point.getDistance(),
                                          point.getLifeTime(), color);
            }
        }
    }

    btCollisionWorld& m_world;
    const Context& m_context;
    btIDebugDraw& m_drawer;
    const DebugDrawOptions& m_options;
};

}  // namespace

Status debugDraw(btCollisionWorld* world, btIDebugDraw* drawer, const DebugDrawOptions& options) noexcept {
    if (world == nullptr || drawer == nullptr) {
        return Status::nullPointer;
    }
    try {
        const auto* dispatcher = dynamic_cast<const btCollisionDispatcher*>(world->getDispatcher());
        if (dispatcher == nullptr) {
            return Status::badArgument;
        }
        const std::shared_ptr<Context> context = detail::Contexts::instance().find(dispatcher);
        if (!context || !context->isIn(*dispatcher)) {
            return Status::notRegistered;
        }
        Drawing drawing(*world, *context, *drawer, options);
        const int mode = drawer->getDebugMode();
        if ((mode & btIDebugDraw::DBG_DrawAabb) != 0 && options.treeLevel >= 0) {
            drawing.trees();
        }
        if ((mode & btIDebugDraw::DBG_DrawContactPoints) != 0 && (options.pairs || options.contacts)) {
            drawing.pairs();
        }
        return Status::ok;
    } catch (...) {
        return Status::outOfMemory;
    }
}

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
