// All that belongs to one dispatcher, found again by its address.
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <grapeshot/plugin/collision_algorithm.hpp>
#include <grapeshot/plugin/detail/dispatch_tables.hpp>
#include <grapeshot/plugin/detail/frame.hpp>
#include <grapeshot/plugin/detail/soft_loop.hpp>
#include <grapeshot/plugin/detail/soft_surface.hpp>
#include <grapeshot/plugin/settings.hpp>
#include <grapeshot/plugin/statistics.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// One place in the tables that we took, and who had it.
struct Cell {
    Table table = Table::contacts;
    int first = 0;
    int second = 0;
    btCollisionAlgorithmCreateFunc* previous = nullptr;
    btCollisionAlgorithmCreateFunc* placed = nullptr;  ///< by us: our creator, or Bullet's for compounds
    bool wasEmpty = false;                             ///< it was Bullet's empty algorithm
    btCollisionAlgorithmCreateFunc* asked = nullptr;   ///< whom `placed` asks first; null: `previous`
};

class ShapeEntry;

/// Every algorithm holds its context, so that it outlives them all.
struct Context : std::enable_shared_from_this<Context> {
    explicit Context(const Settings& chosen);
    ~Context();

    /// Takes (again) all places in the tables.
    void install(btCollisionDispatcher& dispatcher);
    /// Gives them back. False if somebody else holds one of them.
    bool uninstall(btCollisionDispatcher& dispatcher);
    [[nodiscard]] std::size_t heldCells(const btCollisionDispatcher& dispatcher) const;
    /// Is any creator of ours in them? If not, this context was another dispatcher's, at the same address.
    [[nodiscard]] bool isIn(const btCollisionDispatcher& dispatcher) const;

    /// An algorithm for what is not ours: from whoever had the place, else Bullet's GImpact algorithm if a GImpact
    /// shape is in it. Null if there is none.
    btCollisionAlgorithm* createForeign(btCollisionAlgorithmConstructionInfo& info,
                                        const btCollisionObjectWrapper* body0, const btCollisionObjectWrapper* body1,
                                        Table table);
    /// The same for two shapes of a place in the contact table: from whoever had it (of compounds GImpact's gives way
    /// to Bullet's recursion), null if nobody.
    btCollisionAlgorithm* createPrevious(btCollisionAlgorithmConstructionInfo& info,
                                         const btCollisionObjectWrapper& body0, const btCollisionObjectWrapper& body1);

    /// A pair comes by that was last processed in `lastStep` (0: never): begins a new step if it was this one. Returns
    /// the step.
    std::uint64_t enterStep(std::uint64_t lastStep);
    /// Adds the pair to the sums of the step.
    void record(const PairStatistics& pair);
    /// An algorithm of ours was made for two shapes of these types.
    void countAlgorithm(int shapeType0, int shapeType1);
    void refuse(PairStatistics pair, const std::string& reason);

    /// The frame of a Dispatcher while its dispatch goes on, if its budget is limited; else null.
    [[nodiscard]] Frame* openFrame() { return dispatching && frame.isLimited() ? &frame : nullptr; }
    void beginStep();
    /// After work was paid for.
    void reportFrame();

    Settings settings;
    Frame frame;
    std::vector<std::shared_ptr<ShapeEntry>> building;  ///< shapes of this dispatch whose trees are not there yet
    std::uint64_t dispatches = 0;                       ///< of a dispatcher of ours, since registration
    bool beside = false;                                ///< only looks on: see Pace::beside
    bool framed = false;                                ///< the dispatcher is one of ours: it says when a step begins
    bool dispatching = false;                           ///< it is between the begin and the end of a dispatch
    StepStatistics statistics;
    std::vector<Cell> cells;
    std::array<std::unique_ptr<MeshCollisionAlgorithm::CreateFunc>, 2> creators;  ///< by Table
    std::unique_ptr<btCollisionAlgorithmCreateFunc> gimpact;
    std::unique_ptr<btCollisionAlgorithmCreateFunc> soft;
    std::unique_ptr<btCollisionAlgorithmCreateFunc> sweptCompounds;
    SoftEntries softEntries;
    SoftLoop softLoop;
    bool lostCells = false;  ///< somebody took one of our places, and may have kept our creator as the one before him
    std::uint64_t settingsVersion = 0;  ///< rises when settings are set
    std::uint64_t serial = 0;           ///< different for each context of the process

  private:
    void take(btCollisionDispatcher& dispatcher, Table table, int first, int second,
              btCollisionAlgorithmCreateFunc* placed = nullptr);
    void takeSolids(btCollisionDispatcher& dispatcher, Table table);
    void takeCompounds(btCollisionDispatcher& dispatcher, Table table);
    void takeSoft(btCollisionDispatcher& dispatcher);
    void takeSweptCompounds(btCollisionDispatcher& dispatcher);
    void takeSweptCompound(btCollisionDispatcher& dispatcher, int first, int second);
    void giveBackUnwanted(btCollisionDispatcher& dispatcher);
    void takeIfEmpty(btCollisionDispatcher& dispatcher, Table table, int first, int second);
    void giveBack(btCollisionDispatcher& dispatcher, const Cell& cell) const;
};

/// Contexts by dispatcher.
class Contexts {
  public:
    static Contexts& instance();
    /// Null if there is none for this address.
    std::shared_ptr<Context> find(const btCollisionDispatcher* dispatcher);
    void insert(const btCollisionDispatcher* dispatcher, std::shared_ptr<Context> context);
    /// `keep`: somebody may still hold our creators as his previous ones.
    void remove(const btCollisionDispatcher* dispatcher, bool keep);

  private:
    struct Item {
        const btCollisionDispatcher* dispatcher = nullptr;
        std::shared_ptr<Context> context;
    };
    std::mutex m_mutex;
    std::vector<Item> m_items;
    std::vector<std::shared_ptr<Context>> m_kept;
};

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
