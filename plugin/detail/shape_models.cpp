#include <grapeshot/plugin/detail/shape_models.hpp>

#include <algorithm>
#include <atomic>

#include <grapeshot/core/error.hpp>

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
                                                    std::uint64_t step) {
    const std::lock_guard lock(m_mutex);
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
        const bool unchanged =
            !m_changed && m_model && m_found == m_sources &&
            (m_model->mesh ? isUnchanged(thorough ? thoroughly : sampledVertices,
                                         thorough ? thoroughly : sampledTriangles)
                           : !thorough);  // what could not be used is read again when a new pair asks
        if (!unchanged) {
            m_sources.swap(m_found);
            read(cache);
        }
    } catch (const Error& error) {
        auto failed = std::make_shared<ShapeModel>();
        failed->error = error.what();
        failed->topology = nextTopology();
        m_model = std::move(failed);
        if (!described) {
            m_sources.clear();  // so that whatever is described next is read
        }
    }
    m_changed = false;
    return m_model;
}

void ShapeEntry::notifyChanged() {
    const std::lock_guard lock(m_mutex);
    m_changed = true;
}

std::shared_ptr<const ShapeModel> ShapeEntry::present() {
    const std::lock_guard lock(m_mutex);
    return m_model;
}

bool ShapeEntry::isUnchanged(std::size_t vertices, std::size_t triangles) {
    const Tree& tree = m_model->mesh->tree;
    const std::size_t phase = m_cursor++;
    std::uint32_t firstVertex = 0;
    std::uint32_t firstTriangle = 0;
    for (const PartSource& source : m_sources) {
        const auto vertexCount = static_cast<std::size_t>(source.vertices);
        const auto triangleCount = static_cast<std::size_t>(source.triangles);
        const auto sameVertex = [&](std::size_t i) {
            return sameBits(source.vertex(static_cast<int>(i)), tree.vertices[firstVertex + i]);
        };
        const auto sameTriangle = [&](std::size_t i) {
            Triangle triangle = source.triangle(static_cast<int>(i));
            for (std::uint32_t& corner : triangle) {
                corner += firstVertex;
            }
            return triangle == tree.triangles[firstTriangle + i];
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

void ShapeEntry::read(ModelCache& cache) {
    ShapeMesh mesh = readMesh(m_sources);
    auto model = std::make_shared<ShapeModel>();
    model->parts = std::move(mesh.parts);
    const MeshModel* old = m_model ? m_model->mesh.get() : nullptr;
    if (old != nullptr && old->tree.triangles == mesh.triangles && old->tree.vertices.size() == mesh.vertices.size()) {
        model->topology = m_model->topology;
        if (std::equal(mesh.vertices.begin(), mesh.vertices.end(), old->tree.vertices.begin(), sameBits)) {
            model->mesh = m_model->mesh;
        } else {
            // The old one may be in use by other shapes and other threads.
            auto moved = std::make_shared<MeshModel>(*old);
            refit(*moved, mesh.vertices);
            model->mesh = std::move(moved);
        }
    } else {
        model->topology = nextTopology();
        model->mesh = cache.get(mesh.view());
    }
    m_model = std::move(model);
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

std::shared_ptr<const ShapeModel> ShapeModels::present(const btCollisionShape& shape) {
    const std::shared_ptr<ShapeEntry> found = known(shape);
    return found ? found->present() : nullptr;
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
