// A look into the tables of a dispatcher: who makes the algorithm for a pair of shape types.
//
// Bullet has functions to fill the tables but none to read them; they are protected members. The configuration that
// filled them at first does not know who registered since.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

#include <grapeshot/plugin/precision.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

enum class Table {
    contacts,  ///< pairs of the simulation
    closest,   ///< contactTest and contactPairTest
};

[[nodiscard]] inline btCollisionAlgorithmCreateFunc* creatorIn(const btCollisionDispatcher& dispatcher, Table table,
                                                               int first, int second) {
    struct Opened : btCollisionDispatcher {
        using btCollisionDispatcher::btCollisionDispatcher;
        static auto contacts() { return &Opened::m_doubleDispatchContactPoints; }
        static auto closest() { return &Opened::m_doubleDispatchClosestPoints; }
    };
    return table == Table::contacts ? (dispatcher.*Opened::contacts())[first][second]
                                    : (dispatcher.*Opened::closest())[first][second];
}

inline void setCreator(btCollisionDispatcher& dispatcher, Table table, int first, int second,
                       btCollisionAlgorithmCreateFunc* creator) {
    if (table == Table::contacts) {
        dispatcher.registerCollisionCreateFunc(first, second, creator);
    } else {
        dispatcher.registerClosestPointsCreateFunc(first, second, creator);
    }
}

/// What Bullet's configurations give where they know no algorithm.
[[nodiscard]] inline btCollisionAlgorithmCreateFunc* emptyCreatorIn(const btCollisionDispatcher& dispatcher,
                                                                    Table table) {
    return creatorIn(dispatcher, table, EMPTY_SHAPE_PROXYTYPE, EMPTY_SHAPE_PROXYTYPE);
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
