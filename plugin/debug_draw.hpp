// Trees, pairs and contacts through a program's btIDebugDraw.
#pragma once

#include <LinearMath/btVector3.h>

#include <grapeshot/plugin/precision.hpp>
#include <grapeshot/plugin/status.hpp>

class btCollisionWorld;
class btIDebugDraw;

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

/// Colours are red, green, blue in 0..1.
struct DebugDrawOptions {
    /// Deepest level of the trees whose boxes are drawn, 0 the whole mesh, each level up to four times as many boxes as
    /// the one above; negative: none.
    int treeLevel = 2;
    bool pairs = true;
    bool contacts = true;
    btVector3 treeColor{0.3F, 0.5F, 1};
    btVector3 certainColor{0, 1, 0};  ///< pairs in which nothing was left out in their last step, and their contacts
    btVector3 estimatedColor{1, 0.6F, 0};  ///< pairs that were cut short, or a mesh of which waits for its tree: kept,
                                           ///< partial or estimated contacts
    btVector3 refusedColor{1, 0, 0};       ///< pairs without an answer
};

/// Draws what is ours in a world, between steps, as the drawer's mode asks: with DBG_DrawAabb the boxes of trees (of
/// meshes that have one already; of the sample that stands in for a tree being built) where their bodies are; with
/// DBG_DrawContactPoints a line between the two bodies of each pair, and its contacts (drawContactPoint). Builds
/// nothing and changes nothing. Pairs within compounds that were not processed in the last step, because both bodies
/// sleep, are left out.
/// @return nullPointer; badArgument: the world's dispatcher is no btCollisionDispatcher; notRegistered
Status debugDraw(btCollisionWorld* world, btIDebugDraw* drawer, const DebugDrawOptions& options = {}) noexcept;

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
