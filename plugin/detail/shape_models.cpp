#include <grapeshot/plugin/detail/shape_models.hpp>

#include <algorithm>
#include <atomic>

#include <grapeshot/adb/tree_builder.hpp>
#include <grapeshot/core/error.hpp>
#include <grapeshot/narrowphase/model_builder.hpp>
#include <grapeshot/plugin/detail/sampled_mesh.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

constexpr std::size_t sampledVertices = 64;
constexpr std::size_t sampledTriangles = 16;
constexpr std::size_t thoroughly = 4096;
constexpr std::size_t idleEntries = 256;

std::uint64_t nextTopology() {
    static std::atomic<std::uint64_t> last = 0;
    return ++last;
}

bool sameBits(const Eigen::Vector3f& left, const Eigen::Vector3f& right) {
    return left.x() == right.x() && left.y() == right.y() && left.z() == right.z();
}

/// Calls visit(i) for up to `count` of `size` indices, evenly spread, beginning `phase` later each time; false as soon
/// as it says so.
template <class Visit>
bool visitSample(std::size_t size, std::size_t count, std::size_t phase, Visit&& visit) {
    const std::size_t stride = std::max<std::size_t>(1, size / count);
    for (std::size_t i = phase % stride; i < size; i += stride) {
        if (!visit(i)) {
            return false;
        }
    }
    return true;
}

}  // namespace

std::shared_ptr<const ShapeModel> ShapeEntry::model(const btCollisionShape& shape, ModelCache& cache, Check check,
                                                    std::uint64_t step, Pace pace, std::uint64_t& work, bool features) {
    const std::lock_guard lock(m_mutex);
    if (features && !m_features) {
        m_features = true;
        m_changed = m_changed || m_model != nullptr || m_building != nullptr;
    }
    if (m_building != nullptr && pace == Pace::beside) {
        return m_model;
    }
    if (m_model && !m_changed && check == Check::sampled && step != 0 && m_checkedStep == step) {
        return m_model;
    }
    // Once a step is enough, however many pairs are new.
    const bool thorough = check == Check::thorough && (step == 0 || m_thoroughStep != step);
    m_checkedStep = step;
    m_thoroughStep = thorough ? step : m_thoroughStep;
    m_found.clear();
    bool described = false;
    try {
        sourcesOf(shape, m_found);
        described = true;
        const bool sameSources = m_model && m_found == m_sources;
        const bool unchanged =
            !m_changed && sameSources &&
            // What is being built is looked at when it is there; but another shape may have taken the address
            // meanwhile.
            (m_building != nullptr ? !m_letGo || isUnchanged(m_building->mesh.vertices, m_building->mesh.triangles,
                                                             thoroughly, thoroughly)
             : m_model->mesh       ? isUnchanged(m_model->mesh->tree.vertices, m_model->mesh->tree.triangles,
                                           thorough ? thoroughly : sampledVertices,
                                           thorough ? thoroughly : sampledTriangles)
                                   : !thorough);  // what could not be used is read again when a new pair asks
        if (!unchanged) {
            m_sources.swap(m_found);
            read(cache, pace, sameSources && m_model->mesh && !m_letGo, work);
        } else if (m_building != nullptr && pace == Pace::atOnce) {
            m_building->work->run();
            finish();
        }
    } catch (const Error& error) {
        fail(error.what());
        if (!described) {
            m_sources.clear();  // so that whatever is described next is read
        }
    } catch (...) {
        beginAnew();
        throw;
    }
    m_changed = m_letGo = false;
    return m_model;
}

void ShapeEntry::notifyChanged() {
    const std::lock_guard lock(m_mutex);
    m_changed = true;
}

void ShapeEntry::letGo() {
    const std::lock_guard lock(m_mutex);
    m_letGo = true;
}

std::shared_ptr<const ShapeModel> ShapeEntry::present() {
    const std::lock_guard lock(m_mutex);
    return m_model;
}

bool ShapeEntry::isBuilding() const {
    const std::lock_guard lock(m_mutex);
    return m_building != nullptr;
}

std::uint64_t ShapeEntry::goOnBuilding(const Budget& budget) {
    const std::lock_guard lock(m_mutex);
    if (m_building == nullptr) {
        return 0;
    }
    Sliced& building = *m_building->work;
    std::uint64_t work = 0;
    try {
        work = building.run(budget);
        if (building.isDone()) {
            finish();
        }
    } catch (const Error& error) {
        work = building.spent();
        fail(error.what());
    } catch (...) {
        work = building.spent();
        beginAnew();  // out of memory: the stand-in stays
    }
    return work;
}

void ShapeEntry::beginAnew() {
    m_building.reset();
    m_changed = true;
}

void ShapeEntry::finish() {
    m_model = std::move(m_building->made);
    m_building.reset();
}

void ShapeEntry::fail(const std::string& error) {
    m_building.reset();
    auto failed = std::make_shared<ShapeModel>();
    failed->error = error;
    failed->topology = nextTopology();
    m_model = std::move(failed);
}

bool ShapeEntry::isUnchanged(std::span<const Eigen::Vector3f> readVertices, std::span<const Triangle> readTriangles,
                             std::size_t vertices, std::size_t triangles) {
    const std::size_t phase = m_cursor++;
    std::uint32_t firstVertex = 0;
    std::uint32_t firstTriangle = 0;
    for (const PartSource& source : m_sources) {
        const auto vertexCount = static_cast<std::size_t>(source.vertices);
        const auto triangleCount = static_cast<std::size_t>(source.triangles);
        const auto sameVertex = [&](std::size_t i) {
            return firstVertex + i >= readVertices.size() ||
                   sameBits(source.vertex(static_cast<int>(i)), readVertices[firstVertex + i]);
        };
        const auto sameTriangle = [&](std::size_t i) {
            if (firstTriangle + i >= readTriangles.size()) {
                return true;
            }
            Triangle triangle = source.triangle(static_cast<int>(i));
            for (std::uint32_t& corner : triangle) {
                corner += firstVertex;
            }
            return triangle == readTriangles[firstTriangle + i];
        };
        if (!visitSample(vertexCount, vertices, phase, sameVertex) ||
            !visitSample(triangleCount, triangles, phase, sameTriangle)) {
            return false;
        }
        firstVertex += static_cast<std::uint32_t>(vertexCount);
        firstTriangle += static_cast<std::uint32_t>(triangleCount);
    }
    return true;
}

Sliced ShapeEntry::build(Building& building, ModelCache& cache, bool features) {
    co_await readMeshInSlices(building.sources, building.mesh);
    const ShapeMesh& mesh = building.mesh;
    ShapeModel& made = *building.made;
    made.parts = mesh.parts;
    const MeshModel* old = building.old ? building.old->mesh.get() : nullptr;
    bool sameTriangles = old != nullptr && old->tree.triangles.size() == mesh.triangles.size() &&
                         old->tree.vertices.size() == mesh.vertices.size();
    if (sameTriangles) {
        const auto compare = [&](std::size_t begin, std::size_t end) {
            sameTriangles =
                sameTriangles && std::equal(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(begin),
                                            mesh.triangles.begin() + static_cast<std::ptrdiff_t>(end),
                                            old->tree.triangles.begin() + static_cast<std::ptrdiff_t>(begin));
        };
        co_await inPieces(0, mesh.triangles.size(), 64, compare);
    }
    if (!sameTriangles) {
        made.topology = nextTopology();
        co_await cache.getInSlices(mesh.view(), {.tuningPoses = 0}, made.mesh, features);
        co_return;
    }
    made.topology = building.old->topology;
    bool sameVertices = true;
    const auto compare = [&](std::size_t begin, std::size_t end) {
        sameVertices =
            sameVertices && std::equal(mesh.vertices.begin() + static_cast<std::ptrdiff_t>(begin),
                                       mesh.vertices.begin() + static_cast<std::ptrdiff_t>(end),
                                       old->tree.vertices.begin() + static_cast<std::ptrdiff_t>(begin), sameBits);
    };
    co_await inPieces(0, mesh.vertices.size(), 64, compare);
    if (sameVertices && (!features || old->features)) {
        made.mesh = building.old->mesh;
        co_return;
    }
    // The old one may be in use by other shapes and other threads.
    auto moved = std::make_shared<MeshModel>();
    co_await copyInSlices(*old, *moved);
    if (!sameVertices) {
        co_await refitInSlices(*moved, mesh.vertices);
    }
    if (features) {
        co_await addFeaturesInSlices(*moved);
    }
    made.mesh = std::move(moved);
}

/// What the shape was, if it was merely edited; else a sample.
std::shared_ptr<const ShapeModel> ShapeEntry::standIn(bool edited, std::uint64_t& work) const {
    auto model = std::make_shared<ShapeModel>();
    model->isStandIn = true;
    if (edited) {
        model->mesh = m_model->mesh;
        model->parts = m_model->parts;
        model->topology = m_model->topology;
        return model;
    }
    model->topology = nextTopology();
    const ShapeMesh sample = sampledMesh(m_sources);
    try {
        auto mesh = std::make_shared<MeshModel>();
        Sliced tree = buildInSlices(sample.view(), {.tuningPoses = 0}, mesh->tree);
        work += tree.run();
        Sliced rest = makeModelInSlices(*mesh);
        work += rest.run();
        model->mesh = std::move(mesh);
    } catch (const Error&) {
        model->error = "its tree is being built, and no sample of its triangles has a surface";
    }
    return model;
}

void ShapeEntry::read(ModelCache& cache, Pace pace, bool edited, std::uint64_t& work) {
    std::size_t triangles = 0;
    for (const PartSource& source : m_sources) {
        triangles += static_cast<std::size_t>(source.triangles);
    }
    std::shared_ptr<const ShapeModel> old = m_building != nullptr ? m_building->old : m_model;
    m_building = std::make_unique<Building>();
    m_building->sources = m_sources;
    m_building->old = m_letGo ? nullptr : std::move(old);
    m_building->work.emplace(build(*m_building, cache, m_features));
    if (pace == Pace::inSlices && triangles > 2 * sampledShapeTriangles) {
        m_model = standIn(edited, work);
        return;
    }
    const std::uint64_t spent = m_building->work->run();
    work += pace == Pace::inSlices ? spent : 0;
    finish();
}

ShapeModels& ShapeModels::instance() {
    // Never destroyed: a program's last world may be destroyed later than static objects.
    static ShapeModels& models = *new ShapeModels;
    return models;
}

std::shared_ptr<ShapeEntry> ShapeModels::entry(const btCollisionShape& shape) {
    const std::lock_guard lock(m_mutex);
    Place& place = m_entries[&shape];
    if (!place.entry) {
        place.entry = std::make_shared<ShapeEntry>();
    }
    if (place.entry.use_count() == 1) {
        place.entry->letGo();
    }
    place.lastUse = ++m_use;
    std::shared_ptr<ShapeEntry> found = place.entry;
    if (m_entries.size() > m_limit) {
        dropIdle();
    }
    return found;
}

std::shared_ptr<ShapeEntry> ShapeModels::known(const btCollisionShape& shape) {
    const std::lock_guard lock(m_mutex);
    const auto place = m_entries.find(&shape);
    return place != m_entries.end() ? place->second.entry : nullptr;
}

void ShapeModels::notifyChanged(const btCollisionShape& shape) {
    // One that is not known will be read when it is met.
    if (const std::shared_ptr<ShapeEntry> found = known(shape)) {
        found->notifyChanged();
    }
}

std::shared_ptr<const ShapeModel> ShapeModels::present(const btCollisionShape& shape, bool onlyIfHeld) {
    const std::shared_ptr<ShapeEntry> found = known(shape);
    constexpr long idle = 2;  // the table and this
    return found && (!onlyIfHeld || found.use_count() > idle) ? found->present() : nullptr;
}

/// Under the lock. Which go depends on when they were used, not on their addresses.
void ShapeModels::dropIdle() {
    std::vector<std::uint64_t> idle;
    for (const auto& [shape, place] : m_entries) {
        if (place.entry.use_count() == 1) {
            idle.push_back(place.lastUse);
        }
    }
    std::sort(idle.begin(), idle.end());
    if (idle.size() > idleEntries) {
        const std::uint64_t newest = idle[idle.size() - idleEntries - 1];
        std::erase_if(m_entries, [newest](const auto& item) {
            return item.second.entry.use_count() == 1 && item.second.lastUse <= newest;
        });
    }
    m_limit = std::max<std::size_t>(512, 2 * m_entries.size());
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
