// What the preloaded library asks of the one that knows Bullet, by name: the two are linked at run time, when it is
// known in which precision the program has its Bullet.
#pragma once

class btCollisionDispatcher;

// C names, because they are looked up. All of them are silent about dispatchers that they don't know, and throw
// nothing.
extern "C" {
/// After its constructor, or after somebody registered over us: our algorithms are put in place.
using GrapeshotTakeOver = void(btCollisionDispatcher*) noexcept;
/// Before its destructor, or at the end of the program: the report on it is written, and what stood there is restored.
using GrapeshotLetGo = void(btCollisionDispatcher*) noexcept;
}

namespace grapeshot::preload {

inline constexpr char takeOverName[] = "grapeshotTakeOver";
inline constexpr char letGoName[] = "grapeshotLetGo";

/// Settings of the preloaded library come by the environment.
inline constexpr char logVariable[] = "GRAPESHOT_PRELOAD_LOG";        ///< file to append to; else standard error
inline constexpr char budgetVariable[] = "GRAPESHOT_PRELOAD_BUDGET";  ///< Settings::pairBudget.work, 1 or more
inline constexpr char exactVariable[] = "GRAPESHOT_PRELOAD_EXACT";    ///< neither empty nor 0: Settings::exact()

/// Of the process that says so if nothing could be taken over; its children may have no Bullet at all.
inline constexpr char processVariable[] = "GRAPESHOT_PRELOAD_PROCESS";

}  // namespace grapeshot::preload
