#include "bullet_check.hpp"

#include <array>
#include <cstring>
#include <string_view>

#include <grapeshot/core/error.hpp>
#include <import/detail/bullet_layout.hpp>

namespace grapeshot::import {
namespace {

using detail::BulletChunk;
using detail::BulletLayout;
using detail::DnaField;
using detail::DnaStruct;

/// A pointer and the count of what must stand behind it.
struct ArrayRule {
    std::string_view type, pointer, count;
    std::size_t each = 1;  // elements per count
};

constexpr std::array rules{
    ArrayRule{"btStridingMeshInterfaceData", "m_meshPartsPtr", "m_numMeshParts"},
    ArrayRule{"btMeshPartData", "m_vertices3f", "m_numVertices"},
    ArrayRule{"btMeshPartData", "m_vertices3d", "m_numVertices"},
    ArrayRule{"btMeshPartData", "m_indices32", "m_numTriangles", 3},
    ArrayRule{"btMeshPartData", "m_3indices16", "m_numTriangles"},
    ArrayRule{"btMeshPartData", "m_3indices8", "m_numTriangles"},
    ArrayRule{"btMeshPartData", "m_indices16", "m_numTriangles", 3},
    ArrayRule{"btConvexHullShapeData", "m_unscaledPointsFloatPtr", "m_numUnscaledPoints"},
    ArrayRule{"btConvexHullShapeData", "m_unscaledPointsDoublePtr", "m_numUnscaledPoints"},
    ArrayRule{"btMultiSphereShapeData", "m_localPositionArrayPtr", "m_localPositionArraySize"},
    ArrayRule{"btCompoundShapeData", "m_childShapePtr", "m_numChildShapes"},
};

/// Which structure a shape of which type (BroadphaseNativeTypes) must be.
struct ShapeRule {
    int type;
    std::string_view structure;
};
constexpr std::array shapeRules{
    ShapeRule{0, "btConvexInternalShapeData"},
    ShapeRule{4, "btConvexHullShapeData"},
    ShapeRule{8, "btConvexInternalShapeData"},
    ShapeRule{9, "btMultiSphereShapeData"},
    ShapeRule{10, "btCapsuleShapeData"},
    ShapeRule{11, "btConeShapeData"},
    ShapeRule{13, "btCylinderShapeData"},
    ShapeRule{21, "btTriangleMeshShapeData"},
    ShapeRule{22, "btScaledTriangleMeshShapeData"},
    ShapeRule{25, "btGImpactMeshShapeData"},
    ShapeRule{28, "btStaticPlaneShapeData"},
    ShapeRule{31, "btCompoundShapeData"},
};

constexpr int deepest = 32;

class Checker {
  public:
    Checker(std::span<const std::byte> bytes, const std::string& place) : m_place(place), m_layout(bytes, place) {}

    void run() {
        for (const BulletChunk& chunk : m_layout.chunks()) {
            if (chunk.code == "SHAP") {
                shape(chunk, 0);
            }
            if (chunk.type == nullptr) {
                continue;
            }
            for (std::size_t i = 0; i < chunk.number; ++i) {
                structure(*chunk.type, chunk.data.subspan(i * chunk.type->size, chunk.type->size), 0);
            }
        }
    }

  private:
    [[nodiscard]] std::int64_t integer(const DnaStruct& type, std::span<const std::byte> data,
                                       std::string_view name) const {
        const DnaField* field = type.find(name);
        if (field == nullptr || field->pointers > 0 || field->size < 4) {
            return 0;
        }
        std::int32_t value = 0;
        std::memcpy(&value, data.data() + field->offset, sizeof value);
        return value;
    }

    /// Rules of the structure and of those that it holds.
    void structure(const DnaStruct& type, std::span<const std::byte> data, int depth) {
        for (const ArrayRule& rule : rules) {
            if (rule.type == type.type) {
                array(rule, type, data);
            }
        }
        if (type.type == "btMeshPartData") {
            corners(type, data);
        }
        for (const DnaField& field : type.fields) {
            if (field.pointers > 0) {
                named(type, field, data);
            } else if (const DnaStruct* inner = m_layout.structure(field.type); inner != nullptr && depth < deepest) {
                for (std::size_t i = 0; i < field.elements && (i + 1) * inner->size <= field.size; ++i) {
                    structure(*inner, data.subspan(field.offset + i * inner->size, inner->size), depth + 1);
                }
            }
        }
    }

    /// Pointers that Bullet follows without asking.
    void named(const DnaStruct& type, const DnaField& field, std::span<const std::byte> data) {
        const bool toShape = field.name == "m_collisionShape" || field.name == "m_childShape";
        if (!toShape) {
            return;
        }
        const std::uint64_t pointer = m_layout.pointerAt(data, field.offset);
        const BulletChunk* target = m_layout.at(pointer);
        if (target == nullptr || target->code != "SHAP") {
            m_layout.fail(type.type + "::" + field.name + " names no shape", m_layout.offsetOf(data) + field.offset);
        }
    }

    void array(const ArrayRule& rule, const DnaStruct& type, std::span<const std::byte> data) {
        const DnaField* field = type.find(rule.pointer);
        if (field == nullptr) {
            return;
        }
        const std::size_t where = m_layout.offsetOf(data) + field->offset;
        const std::uint64_t pointer = m_layout.pointerAt(data, field->offset);
        const std::int64_t count = integer(type, data, rule.count);
        if (count < 0) {
            m_layout.fail(type.type + "::" + std::string(rule.count) + " is " + std::to_string(count), where);
        }
        if (pointer == 0) {
            return;
        }
        const BulletChunk* target = m_layout.at(pointer);
        const DnaStruct* element = m_layout.structure(field->type);
        if (target == nullptr || element == nullptr) {
            m_layout.fail(type.type + "::" + field->name + " points nowhere", where);
        }
        const std::size_t bytes = static_cast<std::size_t>(count) * rule.each * element->size;
        if (bytes > target->data.size()) {
            m_layout.fail(type.type + "::" + std::string(rule.count) + " is " + std::to_string(count) +
                              ", but there are only " + std::to_string(target->data.size()) + " bytes",
                          where);
        }
    }

    /// Triangles name vertices that exist.
    void corners(const DnaStruct& type, std::span<const std::byte> data) {
        const std::int64_t vertices = integer(type, data, "m_numVertices");
        const auto triangles = static_cast<std::size_t>(integer(type, data, "m_numTriangles"));
        struct Kind {
            std::string_view name;
            std::size_t stride, width, perElement, elements;
        };
        for (const Kind& kind :
             {Kind{"m_indices32", 4, 4, 1, 3 * triangles}, Kind{"m_indices16", 4, 2, 1, 3 * triangles},
              Kind{"m_3indices16", 8, 2, 3, triangles}, Kind{"m_3indices8", 4, 1, 3, triangles}}) {
            const DnaField* field = type.find(kind.name);
            const BulletChunk* target =
                field != nullptr ? m_layout.at(m_layout.pointerAt(data, field->offset)) : nullptr;
            if (target == nullptr || m_layout.pointerAt(data, field->offset) == 0) {
                continue;
            }
            for (std::size_t i = 0; i < kind.elements; ++i) {
                for (std::size_t k = 0; k < kind.perElement; ++k) {
                    std::uint32_t index = 0;
                    const std::size_t at = i * kind.stride + k * kind.width;
                    std::memcpy(&index, target->data.data() + at, kind.width);
                    if (index >= vertices) {
                        throw Error(Fault::indexOutOfRange,
                                    "vertex " + std::to_string(index) + " of " + std::to_string(vertices),
                                    m_place + ", byte " + std::to_string(m_layout.offsetOf(target->data) + at));
                    }
                }
            }
        }
    }

    /// The structure is what its type says, and compounds do not hold themselves.
    void shape(const BulletChunk& chunk, int depth) {
        const std::size_t where = m_layout.offsetOf(chunk.data);
        if (chunk.type == nullptr || chunk.number == 0) {
            m_layout.fail("a shape without a structure", where);
        }
        if (depth > deepest) {
            m_layout.fail("compounds in compounds without end", where);
        }
        std::int32_t type = 0;
        const DnaStruct* base = m_layout.structure("btCollisionShapeData");
        const DnaField* field = base != nullptr ? base->find("m_shapeType") : nullptr;
        if (field == nullptr || field->offset + sizeof type > chunk.data.size()) {
            m_layout.fail("a shape without a type", where);
        }
        std::memcpy(&type, chunk.data.data() + field->offset, sizeof type);
        for (const ShapeRule& rule : shapeRules) {
            if (rule.type == type && rule.structure != chunk.type->type) {
                m_layout.fail("a shape of type " + std::to_string(type) + " is a " + chunk.type->type, where);
            }
        }
        if (chunk.type->type != "btCompoundShapeData") {
            return;
        }
        const DnaField* childrenOf = chunk.type->find("m_childShapePtr");
        const BulletChunk* children =
            childrenOf != nullptr ? m_layout.at(m_layout.pointerAt(chunk.data, childrenOf->offset)) : nullptr;
        const DnaField* childOf =
            children != nullptr && children->type != nullptr ? children->type->find("m_childShape") : nullptr;
        for (std::size_t i = 0; childOf != nullptr && i < children->number; ++i) {
            const std::uint64_t pointer =
                m_layout.pointerAt(children->data, i * children->type->size + childOf->offset);
            if (const BulletChunk* child = m_layout.at(pointer); child != nullptr) {
                shape(*child, depth + 1);
            }
        }
    }

    std::string m_place;
    BulletLayout m_layout;
};

}  // namespace

void checkBulletFile(std::span<const std::byte> bytes, const std::string& place) {
    Checker(bytes, place).run();
}

}  // namespace grapeshot::import
