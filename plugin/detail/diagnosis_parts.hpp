// The parts of a diagnosis, each about one kind of thing.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>

#include <string>
#include <vector>

#include <grapeshot/plugin/detail/context.hpp>
#include <grapeshot/plugin/detail/leaf_shapes.hpp>
#include <grapeshot/plugin/diagnose.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// A world, looked at once.
struct Patient {
    const btCollisionWorld* world = nullptr;
    const btCollisionDispatcher* dispatcher = nullptr;
    const Context* context = nullptr;  ///< null: not registered with it
    struct Body {
        const btCollisionObject* object = nullptr;
        bool moves = false;  ///< neither static nor kinematic
        std::vector<PlacedShape> leaves;
    };
    std::vector<Body> bodies;  ///< in the world's order
};

void diagnosePairs(const Patient& patient, std::vector<Finding>& findings);
void diagnoseBodies(const Patient& patient, std::vector<Finding>& findings);
void diagnoseMeshes(const Patient& patient, std::vector<Finding>& findings);
void diagnoseBudget(const Patient& patient, std::vector<Finding>& findings);

/// A number for people.
[[nodiscard]] std::string shortNumber(double value);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
