// A pair's memory, out and in.
#include <utility>

#include <grapeshot/plugin/detail/pair_processor.hpp>
#include <grapeshot/plugin/detail/saved_pair.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

bool PairProcessor::remembers() const {
    for (std::size_t i = 0; i < 2; ++i) {
        if (m_kind == PairKind::foreign || (isMeshOf(m_kind, i) && m_models[i] == nullptr)) {
            return false;
        }
    }
    return true;
}

SavedPair PairProcessor::saved() const {
    SavedPair pair;
    pair.kind = m_kind;
    pair.state = m_contacts.state();
    pair.ahead = m_contacts.ahead();
    pair.manifolds = m_writer.saved();
    pair.lastNeed = m_lastNeed;
    pair.age = m_age;
    pair.staleness = m_staleness;
    pair.cutShort = m_cutShort;
    pair.unwanted = m_unwanted;
    return pair;
}

void PairProcessor::restore(SavedPair pair, const btCollisionObject& body0, const btCollisionObject& body1) {
    const btCollisionObjectWrapper wrap0(nullptr, body0.getCollisionShape(), &body0, body0.getWorldTransform(), -1, -1);
    const btCollisionObjectWrapper wrap1(nullptr, body1.getCollisionShape(), &body1, body1.getWorldTransform(), -1, -1);
    const Bodies bodies{&wrap0, &wrap1};
    m_step = m_context->statistics.step;
    look(bodies);
    PairShapes shapes;
    std::string refusal;
    if (m_kind != pair.kind || !findModels(bodies, m_rebound, shapes, refusal)) {
        return;  // as a new pair
    }
    m_contacts.restore(std::move(pair.state), std::move(pair.ahead));
    m_lastNeed = pair.lastNeed;
    m_age = pair.age;
    m_staleness = pair.staleness;
    m_cutShort = pair.cutShort;
    m_unwanted = pair.unwanted;
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
