// Pairs without an algorithm, with the wrong one, or that need none.
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>

#include <algorithm>

#include <grapeshot/plugin/collision_algorithm.hpp>
#include <grapeshot/plugin/detail/diagnosis_parts.hpp>
#include <grapeshot/plugin/detail/shape_kind.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

/// Bodies that the dispatch tables and the default filter do not tell apart.
struct Kind {
    std::vector<int> types;  // of the leaves, sorted
    int group = 0, mask = 0;
    bool moves = false;
    friend bool operator==(const Kind&, const Kind&) = default;
};

struct KindOfBodies {
    Kind kind;
    std::vector<int> members;  // indices of bodies
};

std::vector<KindOfBodies> kindsOf(const Patient& patient) {
    std::vector<KindOfBodies> kinds;
    for (std::size_t i = 0; i < patient.bodies.size(); ++i) {
        const Patient::Body& body = patient.bodies[i];
        const btBroadphaseProxy* proxy = body.object->getBroadphaseHandle();
        if (proxy == nullptr) {
            continue;
        }
        Kind kind{{}, proxy->m_collisionFilterGroup, proxy->m_collisionFilterMask, body.moves};
        for (const PlacedShape& leaf : body.leaves) {
            kind.types.push_back(leaf.shape->getShapeType());
        }
        std::sort(kind.types.begin(), kind.types.end());
        kind.types.erase(std::unique(kind.types.begin(), kind.types.end()), kind.types.end());
        const auto known =
            std::find_if(kinds.begin(), kinds.end(), [&](const auto& item) { return item.kind == kind; });
        KindOfBodies& place = known != kinds.end() ? *known : kinds.emplace_back();
        place.kind = std::move(kind);
        place.members.push_back(static_cast<int>(i));
    }
    return kinds;
}

/// Has anybody registered for the two? Ours serves all that its places are taken for.
bool hasAlgorithm(const btCollisionDispatcher& dispatcher, const btCollisionShape& first,
                  const btCollisionShape& second) {
    const btCollisionAlgorithmCreateFunc* creator =
        creatorIn(dispatcher, Table::contacts, first.getShapeType(), second.getShapeType());
    return creator != nullptr && creator != emptyCreatorIn(dispatcher, Table::contacts);
}

class PairFinder {
  public:
    PairFinder(const Patient& patient, std::vector<Finding>& findings) : m_patient(patient), m_findings(findings) {}

    void run() {
        const std::vector<KindOfBodies> kinds = kindsOf(m_patient);
        for (std::size_t i = 0; i < kinds.size(); ++i) {
            for (std::size_t j = i; j < kinds.size(); ++j) {
                lookAt(kinds[i], kinds[j], i == j);
            }
        }
        overtaken();
        oldAlgorithms();
    }

  private:
    void lookAt(const KindOfBodies& one, const KindOfBodies& other, bool same) {
        if (same && one.members.size() < 2) {
            return;
        }
        const int first = one.members[0];
        const int second = same ? one.members[1] : other.members[0];
        const Patient::Body& a = bodyAt(first);
        const Patient::Body& b = bodyAt(second);
        const btOverlappingPairCache* cache = m_patient.world->getBroadphase()->getOverlappingPairCache();
        // Bullet forgot the const; nothing is changed.
        const auto proxyOf = [](const Patient::Body& body) {
            return const_cast<btBroadphaseProxy*>(body.object->getBroadphaseHandle());
        };
        if (!cache->needsBroadphaseCollision(proxyOf(a), proxyOf(b))) {
            return;
        }
        const auto n = static_cast<double>(one.members.size());
        const double count = same ? n * (n - 1) / 2 : n * static_cast<double>(other.members.size());
        if (!a.moves && !b.moves) {
            zeroMass(a, b, std::min(first, second), std::max(first, second), count);
            return;
        }
        for (const PlacedShape& leafA : a.leaves) {
            for (const PlacedShape& leafB : b.leaves) {
                if (!hasAlgorithm(*m_patient.dispatcher, *leafA.shape, *leafB.shape)) {
                    without(*leafA.shape, *leafB.shape, std::min(first, second), std::max(first, second), count);
                    return;
                }
            }
        }
    }

    void zeroMass(const Patient::Body& a, const Patient::Body& b, int first, int second, double count) {
        const auto isConcave = [](const PlacedShape& leaf) { return leaf.shape->isConcave(); };
        if (std::none_of(a.leaves.begin(), a.leaves.end(), isConcave) &&
            std::none_of(b.leaves.begin(), b.leaves.end(), isConcave)) {
            return;
        }
        m_findings.push_back({FindingCode::zeroMassPair, Severity::note, first, second, nullptr, count,
                              "Neither is moved by contacts, but their filters let them meet: " + shortNumber(count) +
                                  (count == 1 ? " pair" : " pairs") +
                                  " of which contacts change nothing. Give them a group outside each other's "
                                  "mask, as addRigidBody does by itself."});
    }

    void without(const btCollisionShape& shapeA, const btCollisionShape& shapeB, int first, int second, double count) {
        const bool couldBeOurs =
            kindOf(shapeA, shapeB, Settings{}) != PairKind::foreign || isGImpact(shapeA) || isGImpact(shapeB);
        std::string message = std::string(shapeA.getName()) + " against " + shapeB.getName() + ": " +
                              shortNumber(count) + (count == 1 ? " pair passes" : " pairs pass") +
                              " through each other without a word. ";
        message += couldBeOurs ? "Call grapeshot::registerAlgorithms for the world's dispatcher."
                               : "No algorithm is registered for these shapes: use a triangle mesh, or a collision "
                                 "configuration that knows them.";
        m_findings.push_back({FindingCode::noAlgorithm, Severity::error, first, second, &shapeA, count, message});
    }

    void overtaken() {
        if (m_patient.context == nullptr) {
            return;
        }
        const std::size_t all = m_patient.context->cells.size();
        const std::size_t held = m_patient.context->heldCells(*m_patient.dispatcher);
        if (held < all) {
            m_findings.push_back(
                {FindingCode::overtaken, Severity::warning, -1, -1, nullptr, static_cast<double>(all - held),
                 "Somebody has registered over " + std::to_string(all - held) + " of our " + std::to_string(all) +
                     " places in the dispatch tables, as btGImpactCollisionAlgorithm::"
                     "registerAlgorithm does: call grapeshot::registerAlgorithms after it."});
        }
    }

    void oldAlgorithms() {
        if (m_patient.context == nullptr) {
            return;
        }
        const btOverlappingPairCache* cache = m_patient.world->getBroadphase()->getOverlappingPairCache();
        Finding finding{FindingCode::oldAlgorithm, Severity::warning, -1, -1, nullptr, 0, {}};
        for (int i = 0; i < cache->getNumOverlappingPairs(); ++i) {
            const btBroadphasePair& pair = cache->getOverlappingPairArrayPtr()[i];
            const auto* first = static_cast<const btCollisionObject*>(pair.m_pProxy0->m_clientObject);
            const auto* second = static_cast<const btCollisionObject*>(pair.m_pProxy1->m_clientObject);
            if (pair.m_algorithm == nullptr ||
                !wouldBeOurs(*first->getCollisionShape(), *second->getCollisionShape()) ||
                dynamic_cast<const MeshCollisionAlgorithm*>(pair.m_algorithm) != nullptr) {
                continue;
            }
            if (finding.value++ == 0) {
                finding.first = std::min(first->getWorldArrayIndex(), second->getWorldArrayIndex());
                finding.second = std::max(first->getWorldArrayIndex(), second->getWorldArrayIndex());
            }
        }
        if (finding.value > 0) {
            finding.message = shortNumber(finding.value) +
                              " pairs were made before our algorithms were registered and keep Bullet's until they "
                              "part: register before the first step, or call cleanProxyFromPairs for their bodies.";
            m_findings.push_back(finding);
        }
    }

    [[nodiscard]] bool wouldBeOurs(const btCollisionShape& first, const btCollisionShape& second) const {
        const btCollisionAlgorithmCreateFunc* creator =
            creatorIn(*m_patient.dispatcher, Table::contacts, first.getShapeType(), second.getShapeType());
        return creator == m_patient.context->creators[static_cast<std::size_t>(Table::contacts)].get() &&
               kindOf(first, second, m_patient.context->settings) != PairKind::foreign;
    }

    [[nodiscard]] const Patient::Body& bodyAt(int index) const {
        return m_patient.bodies[static_cast<std::size_t>(index)];
    }

    const Patient& m_patient;
    std::vector<Finding>& m_findings;
};

}  // namespace

void diagnosePairs(const Patient& patient, std::vector<Finding>& findings) {
    PairFinder(patient, findings).run();
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
