#include <grapeshot/plugin/state.hpp>

#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>

#include <algorithm>
#include <optional>
#include <unordered_map>
#include <utility>

#include <grapeshot/core/error.hpp>
#include <grapeshot/plugin/detail/body_state.hpp>
#include <grapeshot/plugin/detail/context.hpp>
#include <grapeshot/plugin/detail/pair_processor.hpp>
#include <grapeshot/plugin/detail/saved_pair.hpp>
#include <grapeshot/plugin/detail/silent_callbacks.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

namespace {

using detail::BodyState;
using detail::Context;
using detail::PairKind;
using detail::PairProcessor;
using detail::SavedPair;

constexpr std::array<char, 8> title{'G', 'S', 'S', 'T', 'A', 'T', 'E', '\n'};
constexpr std::uint32_t version = 3;
constexpr std::size_t headerBytes = title.size() + 4 + 4 + 8 + 16;

/// The parts of a world that are saved.
struct Scene {
    btCollisionWorld* world = nullptr;
    btCollisionDispatcher* dispatcher = nullptr;
    btHashedOverlappingPairCache* cache = nullptr;
    std::shared_ptr<Context> context;

    [[nodiscard]] btCollisionObject& object(std::uint32_t index) const {
        return *world->getCollisionObjectArray()[static_cast<int>(index)];
    }
};

Status open(btCollisionWorld* world, Scene& scene) {
    if (world == nullptr) {
        return Status::nullPointer;
    }
    scene.world = world;
    scene.dispatcher = dynamic_cast<btCollisionDispatcher*>(world->getDispatcher());
    scene.cache = dynamic_cast<btHashedOverlappingPairCache*>(world->getPairCache());
    if (scene.dispatcher == nullptr || scene.cache == nullptr) {
        return Status::badArgument;
    }
    scene.context = detail::Contexts::instance().find(scene.dispatcher);
    return scene.context && scene.context->isIn(*scene.dispatcher) ? Status::ok : Status::notRegistered;
}

/// Keys of models, each worked out once.
class KeyTable {
  public:
    const detail::ModelKeys& of(const MeshModel& model) {
        const auto [place, isNew] = m_keys.try_emplace(&model);
        if (isNew) {
            place->second = detail::keysOf(model);
        }
        return place->second;
    }

  private:
    std::unordered_map<const MeshModel*, detail::ModelKeys> m_keys;
};

/// Null: not ours, or nothing to remember.
PairProcessor* processorOf(const Scene& scene, btCollisionAlgorithm* algorithm) {
    const auto* ours = dynamic_cast<MeshCollisionAlgorithm*>(algorithm);
    PairProcessor* processor = ours != nullptr ? ours->processor() : nullptr;
    return processor != nullptr && processor->isOf(*scene.context) ? processor : nullptr;
}

btCollisionObject* objectOf(const btBroadphaseProxy* proxy) {
    return static_cast<btCollisionObject*>(proxy->m_clientObject);
}

/// A stand-in is not worth saving: nobody could make the same one again in mid-run.
bool isBuilding(const Scene& scene) {
    btBroadphasePairArray& pairs = scene.cache->getOverlappingPairArray();
    for (int i = 0; i < pairs.size(); ++i) {
        const PairProcessor* processor = processorOf(scene, pairs[i].m_algorithm);
        if (processor != nullptr && processor->standsIn()) {
            return true;
        }
    }
    return false;
}

void savePayload(const Scene& scene, ByteWriter& out) {
    KeyTable keys;
    const btCollisionObjectArray& objects = scene.world->getCollisionObjectArray();
    out.put(scene.context->statistics.step);
    out.put(static_cast<std::uint64_t>(objects.size()));
    for (int i = 0; i < objects.size(); ++i) {
        save(detail::stateOf(*objects[i]), out);
    }
    btBroadphasePairArray& pairs = scene.cache->getOverlappingPairArray();
    out.put(static_cast<std::uint64_t>(pairs.size()));
    for (int i = 0; i < pairs.size(); ++i) {
        out.put(static_cast<std::uint32_t>(objectOf(pairs[i].m_pProxy0)->getWorldArrayIndex()));
        out.put(static_cast<std::uint32_t>(objectOf(pairs[i].m_pProxy1)->getWorldArrayIndex()));
        const PairProcessor* processor = processorOf(scene, pairs[i].m_algorithm);
        const bool ours = processor != nullptr && processor->remembers();
        out.put(static_cast<std::uint8_t>(ours));
        if (ours) {
            SavedPair pair = processor->saved();
            for (std::size_t body = 0; body < 2; ++body) {
                if (isMeshOf(pair.kind, body)) {
                    pair.keys[body] = keys.of(*processor->model(body));
                }
            }
            save(pair, out);
        }
    }
}

/// What the bytes say, read and checked before anything is changed.
struct Plan {
    struct Pair {
        std::uint32_t first = 0, second = 0;
        std::optional<SavedPair> ours;
    };
    std::uint64_t step = 0;
    std::vector<BodyState> bodies;
    std::vector<Pair> pairs;
};

class Planner {
  public:
    Planner(const Scene& scene, ByteReader& in) : m_scene(scene), m_in(in) {}

    /// False: of another world. @throws Error badFile
    bool read(Plan& plan) {
        plan.step = m_in.get<std::uint64_t>();
        const std::size_t bodies = m_in.count(1);
        if (bodies != static_cast<std::size_t>(m_scene.world->getNumCollisionObjects())) {
            return false;
        }
        for (std::size_t i = 0; i < bodies; ++i) {
            plan.bodies.push_back(detail::loadBodyState(m_in));
            if (!fits(plan.bodies.back(), m_scene.object(static_cast<std::uint32_t>(i)))) {
                return false;
            }
        }
        plan.pairs.resize(m_in.count(2 * sizeof(std::uint32_t)));
        for (Plan::Pair& pair : plan.pairs) {
            if (!read(pair, bodies)) {
                return false;
            }
        }
        m_in.require(m_in.left() == 0, "more bytes");
        return true;
    }

  private:
    bool read(Plan::Pair& pair, std::size_t bodies) {
        pair.first = m_in.get<std::uint32_t>();
        pair.second = m_in.get<std::uint32_t>();
        m_in.require(pair.first < bodies && pair.second < bodies && pair.first != pair.second,
                     "a pair of bodies that do not exist");
        const bool ours = m_in.flag();
        btBroadphaseProxy* first = m_scene.object(pair.first).getBroadphaseHandle();
        btBroadphaseProxy* second = m_scene.object(pair.second).getBroadphaseHandle();
        if (first == nullptr || second == nullptr || first->getUid() >= second->getUid() ||
            !m_scene.cache->needsBroadphaseCollision(first, second)) {
            return false;
        }
        if (!ours) {
            return true;
        }
        detail::PresentPair present;
        if (!look(pair, present)) {
            return false;
        }
        bool otherWorld = false;
        pair.ours = loadPair(m_in, present, otherWorld);
        return !otherWorld;
    }

    /// False if the pair would not be ours here, or a mesh cannot be used.
    bool look(const Plan::Pair& pair, detail::PresentPair& present) {
        const std::array shapes{m_scene.object(pair.first).getCollisionShape(),
                                m_scene.object(pair.second).getCollisionShape()};
        const btCollisionAlgorithmCreateFunc* creator = creatorIn(*m_scene.dispatcher, detail::Table::contacts,
                                                                  shapes[0]->getShapeType(), shapes[1]->getShapeType());
        present.kind = detail::kindOf(*shapes[0], *shapes[1], m_scene.context->settings);
        if (creator != m_scene.context->creators[static_cast<std::size_t>(detail::Table::contacts)].get() ||
            present.kind == PairKind::foreign) {
            return false;
        }
        for (std::size_t i = 0; i < 2; ++i) {
            if (!isMeshOf(present.kind, i)) {
                continue;
            }
            std::shared_ptr<const detail::ShapeModel>& model = m_models[shapes[i]];
            if (model == nullptr) {
                detail::ShapeModels& all = detail::ShapeModels::instance();
                model = all.entry(*shapes[i])
                            ->model(*shapes[i], all.cache(), detail::Check::thorough, 0,
                                    m_scene.context->settings.method == Method::scf);
            }
            if (!model->mesh) {
                return false;
            }
            present.models[i] = model->mesh.get();
            present.keys[i] = m_keys.of(*model->mesh);
        }
        return true;
    }

    const Scene& m_scene;
    ByteReader& m_in;
    KeyTable m_keys;
    std::unordered_map<const btCollisionShape*, std::shared_ptr<const detail::ShapeModel>> m_models;
};

class Restorer {
  public:
    explicit Restorer(const Scene& scene) : m_scene(scene) {}

    void run(Plan& plan) {
        const detail::SilentCallbacks silence;
        for (std::size_t i = 0; i < plan.bodies.size(); ++i) {
            btCollisionObject& object = m_scene.object(static_cast<std::uint32_t>(i));
            apply(plan.bodies[i], object);
            m_scene.world->updateSingleAabb(&object);
        }
        replacePairs(plan);
        m_scene.context->statistics.step = plan.step;
        std::vector<Adoption> adoptions;
        btBroadphasePairArray& pairs = m_scene.cache->getOverlappingPairArray();
        for (std::size_t i = 0; i < plan.pairs.size(); ++i) {
            if (plan.pairs[i].ours) {
                restore(plan.pairs[i], pairs[static_cast<int>(i)], adoptions);
            }
        }
        std::stable_sort(adoptions.begin(), adoptions.end(),
                         [](const Adoption& x, const Adoption& y) { return x.manifold.place < y.manifold.place; });
        for (const Adoption& adoption : adoptions) {
            adoption.processor->writer().adopt(adoption.index, adoption.manifold, *adoption.first, *adoption.second);
        }
        for (const Adoption& adoption : adoptions) {
            adoption.processor->writer().adopted();
        }
    }

  private:
    struct Adoption {
        PairProcessor* processor = nullptr;
        const btCollisionObject* first = nullptr;
        const btCollisionObject* second = nullptr;
        std::size_t index = 0;  // among the pair's own
        detail::ManifoldState manifold;
    };

    /// Those of the plan in its order, then what the broadphase has found besides; it would not tell again.
    void replacePairs(const Plan& plan) {
        std::vector<std::pair<btBroadphaseProxy*, btBroadphaseProxy*>> found;
        btBroadphasePairArray& pairs = m_scene.cache->getOverlappingPairArray();
        for (int i = 0; i < pairs.size(); ++i) {
            found.emplace_back(pairs[i].m_pProxy0, pairs[i].m_pProxy1);
        }
        for (const auto& [first, second] : found) {
            m_scene.cache->removeOverlappingPair(first, second, m_scene.dispatcher);
        }
        for (const Plan::Pair& pair : plan.pairs) {
            m_scene.cache->addOverlappingPair(m_scene.object(pair.first).getBroadphaseHandle(),
                                              m_scene.object(pair.second).getBroadphaseHandle());
        }
        for (const auto& [first, second] : found) {
            m_scene.cache->addOverlappingPair(first, second);
        }
    }

    void restore(Plan::Pair& planned, btBroadphasePair& pair, std::vector<Adoption>& adoptions) {
        btCollisionObject& first = m_scene.object(planned.first);
        btCollisionObject& second = m_scene.object(planned.second);
        const btCollisionObjectWrapper wrap0(nullptr, first.getCollisionShape(), &first, first.getWorldTransform(), -1,
                                             -1);
        const btCollisionObjectWrapper wrap1(nullptr, second.getCollisionShape(), &second, second.getWorldTransform(),
                                             -1, -1);
        pair.m_algorithm = m_scene.dispatcher->findAlgorithm(&wrap0, &wrap1, nullptr, BT_CONTACT_POINT_ALGORITHMS);
        PairProcessor* processor = processorOf(m_scene, pair.m_algorithm);
        if (processor == nullptr) {
            return;
        }
        for (const detail::ManifoldState& manifold : planned.ours->manifolds) {
            const auto index = static_cast<std::size_t>(&manifold - planned.ours->manifolds.data());
            adoptions.push_back({processor, &first, &second, index, manifold});
        }
        processor->restore(std::move(*planned.ours), first, second);
    }

    const Scene& m_scene;
};

/// @throws Error badFile
std::span<const std::byte> payloadOf(std::span<const std::byte> bytes) {
    ByteReader in(bytes);
    const std::span<const std::byte> start = in.take(title.size());
    in.require(std::equal(start.begin(), start.end(), std::as_bytes(std::span(title)).begin()), "no saved state");
    in.require(in.get<std::uint32_t>() == version, "another version");
    in.require(in.get<std::uint32_t>() == sizeof(btScalar), "another precision");
    in.require(in.get<std::uint64_t>() == bytes.size() - headerBytes, "another size");
    ContentKey key;
    key.low = in.get<std::uint64_t>();
    key.high = in.get<std::uint64_t>();
    const std::span<const std::byte> payload = in.take(in.left());
    in.require(contentKey(payload) == key, "changed");
    return payload;
}

}  // namespace

Status saveState(btCollisionWorld* world, std::vector<std::byte>& out) noexcept {
    out.clear();
    try {
        Scene scene;
        if (const Status status = open(world, scene); status != Status::ok) {
            return status;
        }
        if (isBuilding(scene)) {
            return Status::stillBuilding;
        }
        std::vector<std::byte> payload;
        ByteWriter inner(payload);
        savePayload(scene, inner);
        ByteWriter outer(out);
        const ContentKey key = contentKey(std::span<const std::byte>(payload));
        outer.put(std::as_bytes(std::span(title)));
        outer.put(version);
        outer.put(static_cast<std::uint32_t>(sizeof(btScalar)));
        outer.put(static_cast<std::uint64_t>(payload.size()));
        outer.put(key.low);
        outer.put(key.high);
        outer.put(std::span<const std::byte>(payload));
        return Status::ok;
    } catch (...) {
        out.clear();
        return Status::outOfMemory;
    }
}

Status restoreState(btCollisionWorld* world, std::span<const std::byte> bytes) noexcept {
    try {
        Scene scene;
        if (const Status status = open(world, scene); status != Status::ok) {
            return status;
        }
        ByteReader in(payloadOf(bytes));
        Plan plan;
        if (!Planner(scene, in).read(plan)) {
            return Status::otherWorld;
        }
        Restorer(scene).run(plan);
        return Status::ok;
    } catch (const Error&) {
        return Status::badState;
    } catch (...) {
        return Status::outOfMemory;
    }
}

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
