#include <grapeshot/plugin/detail/twin_dispatcher.hpp>

#include <LinearMath/btPoolAllocator.h>

#include <algorithm>

#include <grapeshot/plugin/detail/context.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

template <class Visit>
void forEachPlace(Visit&& visit) {
    for (const Table table : {Table::contacts, Table::closest}) {
        for (int first = 0; first < MAX_BROADPHASE_COLLISION_TYPES; ++first) {
            for (int second = 0; second < MAX_BROADPHASE_COLLISION_TYPES; ++second) {
                visit(table, first, second);
            }
        }
    }
}

btDefaultCollisionConstructionInfo constructionInfo(int slotBytes) {
    btDefaultCollisionConstructionInfo info;
    info.m_defaultMaxPersistentManifoldPoolSize = 256;
    info.m_defaultMaxCollisionAlgorithmPoolSize = 256;
    info.m_customCollisionAlgorithmMaxElementSize = slotBytes;
    return info;
}

}  // namespace

TableCopy tablesOf(const btCollisionDispatcher& dispatcher, bool withoutOurs) {
    const std::shared_ptr<Context> context = withoutOurs ? Contexts::instance().find(&dispatcher) : nullptr;
    TableCopy copy;
    copy.reserve(std::size_t{2} * MAX_BROADPHASE_COLLISION_TYPES * MAX_BROADPHASE_COLLISION_TYPES);
    forEachPlace([&](Table table, int first, int second) {
        btCollisionAlgorithmCreateFunc* creator = creatorIn(dispatcher, table, first, second);
        if (context && creator == context->creators[static_cast<std::size_t>(table)].get()) {
            const auto cell = std::find_if(context->cells.begin(), context->cells.end(), [&](const Cell& candidate) {
                return candidate.table == table && candidate.first == first && candidate.second == second;
            });
            creator = cell != context->cells.end() ? cell->previous : emptyCreatorIn(dispatcher, table);
        }
        copy.push_back(creator);
    });
    return copy;
}

TwinAlgorithm::~TwinAlgorithm() {
    m_algorithm->~btCollisionAlgorithm();
    m_dispatcher->freeCollisionAlgorithm(m_algorithm);
}

TwinDispatcher::TwinDispatcher(int slotBytes)
    : m_configuration(constructionInfo(slotBytes)), m_dispatcher(&m_configuration) {}

void TwinDispatcher::setTables(const TableCopy& tables) {
    std::size_t place = 0;
    forEachPlace(
        [&](Table table, int first, int second) { setCreator(m_dispatcher, table, first, second, tables[place++]); });
}

std::unique_ptr<TwinAlgorithm> TwinDispatcher::make(const btCollisionObjectWrapper& first,
                                                    const btCollisionObjectWrapper& second) {
    btCollisionAlgorithm* algorithm = m_dispatcher.findAlgorithm(&first, &second, nullptr, BT_CONTACT_POINT_ALGORITHMS);
    return algorithm != nullptr ? std::make_unique<TwinAlgorithm>(m_dispatcher, algorithm) : nullptr;
}

int slotBytes(btCollisionDispatcher& original) {
    btCollisionConfiguration* configuration = original.getCollisionConfiguration();
    btPoolAllocator* pool = configuration != nullptr ? configuration->getCollisionAlgorithmPool() : nullptr;
    return pool != nullptr ? std::max(pool->getElementSize(), 512) : 512;
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
