#include <grapeshot/plugin/detail/shape_mesh.hpp>

#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btScaledBvhTriangleMeshShape.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include <grapeshot/core/error.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

// Arrays of any alignment.
template <class T>
T readAs(const unsigned char* from) {
    T value;
    std::memcpy(&value, from, sizeof value);
    return value;
}

template <class T>
Triangle readTriangle(const unsigned char* from) {
    const auto corner = readAs<std::array<T, 3>>(from);
    return {corner[0], corner[1], corner[2]};
}

std::size_t sizeOf(PHY_ScalarType type) {
    switch (type) {
        case PHY_FLOAT:
            return sizeof(float);
        case PHY_DOUBLE:
            return sizeof(double);
        case PHY_INTEGER:
            return sizeof(std::uint32_t);
        case PHY_SHORT:
            return sizeof(std::uint16_t);
        case PHY_UCHAR:
            return sizeof(std::uint8_t);
        default:
            return 0;
    }
}

void require(bool condition, Fault fault, const std::string& detail, const std::string& place) {
    if (!condition) {
        throw Error(fault, detail, place);
    }
}

void setScale(PartSource& source, const btVector3& scale, const btVector3& further, const std::string& place) {
    for (int axis = 0; axis < 3; ++axis) {
        source.scale[axis] = static_cast<double>(scale[axis]) * static_cast<double>(further[axis]);
        require(std::isfinite(source.scale[axis]) && source.scale[axis] != 0, Fault::badSetting,
                "scale " + std::to_string(source.scale[axis]), place);
    }
}

void addSource(const btStridingMeshInterface* mesh, int part, const btVector3& scale, const btVector3& further,
               std::vector<PartSource>& sources) {
    const std::string place = "part " + std::to_string(part);
    require(mesh != nullptr, Fault::emptyMesh, "no mesh interface", place);
    require(part >= 0 && part < mesh->getNumSubParts(), Fault::indexOutOfRange, "no such part", place);
    PartSource source;
    source.mesh = mesh;
    source.part = part;
    mesh->getLockedReadOnlyVertexIndexBase(&source.vertexBase, source.vertices, source.vertexType, source.vertexStride,
                                           &source.indexBase, source.indexStride, source.triangles, source.indexType,
                                           part);
    mesh->unLockReadOnlyVertexBase(part);
    setScale(source, scale, further, place);
    require(source.vertices >= 0 && source.triangles >= 0, Fault::badSetting, "a negative count", place);
    require(source.vertexBase != nullptr && source.indexBase != nullptr && source.vertices > 0 && source.triangles > 0,
            Fault::emptyMesh, "no vertices or no triangles", place);
    require(source.vertexType == PHY_FLOAT || source.vertexType == PHY_DOUBLE, Fault::badSetting,
            "vertices of type " + std::to_string(source.vertexType), place);
    require(source.indexType == PHY_INTEGER || source.indexType == PHY_SHORT || source.indexType == PHY_UCHAR,
            Fault::badSetting, "indices of type " + std::to_string(source.indexType), place);
    require(source.vertexStride >= 0 && source.indexStride >= 0, Fault::badSetting, "a negative stride", place);
    sources.push_back(source);
}

void addField(const btHeightfieldTerrainShape& shape, std::vector<PartSource>& sources) {
    const HeightField field = heightFieldOf(shape);
    require(field.columns > 1 && field.rows > 1 && shape.getHeightfieldRawData() != nullptr, Fault::emptyMesh,
            "no heights", "shape");
    require(field.vertices() < 0x7fffffff && field.triangles() < 0x7fffffff, Fault::tooLarge,
            "more than 2^31 triangles", "shape");
    PartSource source;
    source.field = field;
    source.vertexBase = shape.getHeightfieldRawData();
    source.vertices = static_cast<int>(field.vertices());
    source.triangles = static_cast<int>(field.triangles());
    setScale(source, shape.getLocalScaling(), {1, 1, 1}, "shape");
    sources.push_back(source);
}

void addPart(const btGImpactMeshShapePart& part, std::vector<PartSource>& sources) {
    // Bullet forgot the const; nothing is changed.
    const auto* manager = const_cast<btGImpactMeshShapePart&>(part).getTrimeshPrimitiveManager();
    addSource(manager->m_meshInterface, part.getPart(), part.getLocalScaling(), {1, 1, 1}, sources);
}

void addAllParts(const btStridingMeshInterface* mesh, const btVector3& further, std::vector<PartSource>& sources) {
    require(mesh != nullptr, Fault::emptyMesh, "no mesh interface", "shape");
    for (int part = 0; part < mesh->getNumSubParts(); ++part) {
        addSource(mesh, part, mesh->getScaling(), further, sources);
    }
}

void addNames(const PartSource& source, std::uint32_t first, std::vector<MeshPart>& parts) {
    if (source.field.shape == nullptr) {
        parts.push_back({source.part, first});
        return;
    }
    for (int part = 0; part < source.field.parts(); ++part) {
        parts.push_back({part, first});
        first += static_cast<std::uint32_t>(source.field.trianglesPerPart());
    }
}

Error noSuchVertex(const PartSource& source, std::uint32_t index, std::size_t triangle) {
    return {Fault::indexOutOfRange, "vertex " + std::to_string(index) + " of " + std::to_string(source.vertices),
            "triangle " + std::to_string(triangle) + " of part " + std::to_string(source.part)};
}

}  // namespace

TriangleId idOf(std::span<const MeshPart> parts, std::uint32_t triangle) {
    const auto after =
        std::upper_bound(parts.begin(), parts.end(), triangle,
                         [](std::uint32_t value, const MeshPart& part) { return value < part.firstTriangle; });
    if (after == parts.begin()) {
        return {};
    }
    const MeshPart& part = *(after - 1);
    return {part.part, static_cast<int>(triangle - part.firstTriangle)};
}

Eigen::Vector3f PartSource::vertex(int index) const {
    // Beyond single precision (where the conversion would be undefined) is no number.
    const auto narrowed = [](double value) { return std::abs(value) <= 3.4e38 ? static_cast<float>(value) : NAN; };
    if (field.shape != nullptr) {
        const btVector3 point = field.vertex(index);
        return {narrowed(point.x()), narrowed(point.y()), narrowed(point.z())};
    }
    const unsigned char* from = vertexBase + static_cast<std::ptrdiff_t>(index) * vertexStride;
    Eigen::Vector3f result;
    for (int axis = 0; axis < 3; ++axis) {
        const auto at = static_cast<std::ptrdiff_t>(static_cast<std::size_t>(axis) * sizeOf(vertexType));
        const double value =
            vertexType == PHY_FLOAT ? static_cast<double>(readAs<float>(from + at)) : readAs<double>(from + at);
        result[axis] = narrowed(value * scale[axis]);
    }
    return result;
}

Triangle PartSource::triangle(int index) const {
    const unsigned char* from = indexBase + static_cast<std::ptrdiff_t>(index) * indexStride;
    Triangle result = field.shape != nullptr     ? field.triangle(index)
                      : indexType == PHY_INTEGER ? readTriangle<std::uint32_t>(from)
                      : indexType == PHY_SHORT   ? readTriangle<std::uint16_t>(from)
                                                 : readTriangle<std::uint8_t>(from);
    if (scale[0] * scale[1] * scale[2] < 0) {
        std::swap(result[1], result[2]);
    }
    return result;
}

void sourcesOf(const btCollisionShape& shape, std::vector<PartSource>& sources) {
    const btVector3 unscaled(1, 1, 1);
    switch (shape.getShapeType()) {
        case GIMPACT_SHAPE_PROXYTYPE: {
            const auto& gimpact = static_cast<const btGImpactShapeInterface&>(shape);
            if (gimpact.getGImpactShapeType() == CONST_GIMPACT_TRIMESH_SHAPE_PART) {
                addPart(static_cast<const btGImpactMeshShapePart&>(gimpact), sources);
            } else {
                const auto& mesh = static_cast<const btGImpactMeshShape&>(gimpact);
                for (int i = 0; i < mesh.getMeshPartCount(); ++i) {
                    addPart(*mesh.getMeshPart(i), sources);
                }
            }
            break;
        }
        case TRIANGLE_MESH_SHAPE_PROXYTYPE:
        case MULTIMATERIAL_TRIANGLE_MESH_PROXYTYPE:
            addAllParts(static_cast<const btBvhTriangleMeshShape&>(shape).getMeshInterface(), unscaled, sources);
            break;
        case SCALED_TRIANGLE_MESH_SHAPE_PROXYTYPE: {
            const auto& scaled = static_cast<const btScaledBvhTriangleMeshShape&>(shape);
            addAllParts(scaled.getChildShape()->getMeshInterface(), scaled.getLocalScaling(), sources);
            break;
        }
        case TERRAIN_SHAPE_PROXYTYPE:
            addField(static_cast<const btHeightfieldTerrainShape&>(shape), sources);
            break;
        default:
            break;
    }
    require(!sources.empty(), Fault::emptyMesh, "no parts", "shape");
}

Sliced readMeshInSlices(std::span<const PartSource> sources, ShapeMesh& mesh) {
    std::uint64_t vertices = 0;
    std::uint64_t triangles = 0;
    for (const PartSource& source : sources) {
        vertices += static_cast<std::uint64_t>(source.vertices);
        triangles += static_cast<std::uint64_t>(source.triangles);
    }
    require(vertices < 0x7fffffffU && triangles < 0x7fffffffU, Fault::tooLarge, "more than 2^31 vertices or triangles",
            "shape");
    mesh = ShapeMesh();
    mesh.vertices.reserve(vertices);
    mesh.triangles.reserve(triangles);
    for (const PartSource& source : sources) {
        const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
        addNames(source, static_cast<std::uint32_t>(mesh.triangles.size()), mesh.parts);
        const auto readVertices = [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                mesh.vertices.push_back(source.vertex(static_cast<int>(i)));
            }
        };
        co_await inPieces(0, static_cast<std::size_t>(source.vertices), 16, readVertices);
        const auto readTriangles = [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                Triangle triangle = source.triangle(static_cast<int>(i));
                for (std::uint32_t& corner : triangle) {
                    // Here and not later: behind the last vertex of one part are those of the next.
                    if (corner >= static_cast<std::uint32_t>(source.vertices)) {
                        throw noSuchVertex(source, corner, i);
                    }
                    corner += base;
                }
                mesh.triangles.push_back(triangle);
            }
        };
        co_await inPieces(0, static_cast<std::size_t>(source.triangles), 16, readTriangles);
    }
}

ShapeMesh readMesh(std::span<const PartSource> sources) {
    ShapeMesh mesh;
    readMeshInSlices(sources, mesh).run();
    return mesh;
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
