// The layout of a .bullet file: chunks, and the description of their structures that the file brings along (its DNA).
// No Bullet in it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace grapeshot::import::detail {

/// One member of a structure.
struct DnaField {
    std::string type;
    std::string name;  ///< without stars and brackets
    int pointers = 0;  ///< stars
    std::size_t elements = 1;
    std::size_t offset = 0;  ///< bytes
    std::size_t size = 0;    ///< of all elements, bytes
};

struct DnaStruct {
    std::string type;
    std::size_t size = 0;  ///< bytes
    std::vector<DnaField> fields;
    [[nodiscard]] const DnaField* find(std::string_view name) const;
};

struct BulletChunk {
    std::string code;                 ///< four characters
    std::uint64_t pointer = 0;        ///< what other chunks call it
    const DnaStruct* type = nullptr;  ///< null: plain bytes
    std::size_t number = 0;           ///< of structures in it
    std::span<const std::byte> data;
};

class BulletLayout {
  public:
    /// Checks that header, chunks and DNA are whole and agree with each other. Keeps references into `bytes`.
    /// @throws Error badFile; the place is `place` and a byte
    BulletLayout(std::span<const std::byte> bytes, std::string place);

    [[nodiscard]] const std::vector<BulletChunk>& chunks() const { return m_chunks; }
    /// Null: no chunk has this pointer.
    [[nodiscard]] const BulletChunk* at(std::uint64_t pointer) const;
    [[nodiscard]] const DnaStruct* structure(std::string_view type) const;
    [[nodiscard]] bool isDouble() const { return m_double; }

    [[nodiscard]] std::uint64_t pointerAt(std::span<const std::byte> data, std::size_t offset) const;
    [[noreturn]] void fail(const std::string& what, std::size_t byte) const;
    [[nodiscard]] std::size_t offsetOf(std::span<const std::byte> data) const;

  private:
    struct RawChunk;
    void readDna(std::size_t begin, std::size_t end);
    [[nodiscard]] std::uint64_t number(std::size_t at, std::size_t bytes) const;

    std::span<const std::byte> m_bytes;
    std::string m_place;
    std::size_t m_pointerBytes = 8;
    bool m_double = false;
    std::vector<DnaStruct> m_structs;
    std::unordered_map<std::string, std::size_t> m_byType;
    std::vector<BulletChunk> m_chunks;
    std::unordered_map<std::uint64_t, std::size_t> m_byPointer;
};

}  // namespace grapeshot::import::detail
