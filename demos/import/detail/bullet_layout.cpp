#include "bullet_layout.hpp"

#include <algorithm>
#include <cctype>
#include <cstring>

#include <grapeshot/core/error.hpp>

namespace grapeshot::import::detail {
namespace {

constexpr std::size_t headerBytes = 12;  // BULLETf-v324
constexpr std::size_t mostNames = 100'000;

}  // namespace

struct BulletLayout::RawChunk {
    std::string code;
    std::uint64_t pointer = 0;
    std::int64_t type = 0;
    std::uint64_t number = 0;
    std::size_t begin = 0, size = 0;
};

const DnaField* DnaStruct::find(std::string_view name) const {
    const auto found = std::find_if(fields.begin(), fields.end(), [&](const DnaField& f) { return f.name == name; });
    return found != fields.end() ? &*found : nullptr;
}

void BulletLayout::fail(const std::string& what, std::size_t byte) const {
    throw Error(Fault::badFile, what, m_place + ", byte " + std::to_string(byte));
}

std::uint64_t BulletLayout::number(std::size_t at, std::size_t bytes) const {
    if (at + bytes > m_bytes.size()) {
        fail("the file ends", m_bytes.size());
    }
    std::uint64_t value = 0;
    std::memcpy(&value, m_bytes.data() + at, bytes);  // little-endian, as this machine
    return value;
}

BulletLayout::BulletLayout(std::span<const std::byte> bytes, std::string place)
    : m_bytes(bytes), m_place(std::move(place)) {
    const auto text = [&](std::size_t at) { return static_cast<char>(bytes[at]); };
    if (bytes.size() < headerBytes || std::memcmp(bytes.data(), "BULLET", 6) != 0) {
        fail("no .bullet file: it does not begin with BULLET", 0);
    }
    if ((text(6) != 'f' && text(6) != 'd') || (text(7) != '_' && text(7) != '-') || text(8) != 'v') {
        fail("precision, pointer size or byte order is none that can be read", 6);
    }
    m_double = text(6) == 'd';
    m_pointerBytes = text(7) == '_' ? 4 : 8;
    for (std::size_t i = 9; i < headerBytes; ++i) {
        if (std::isdigit(static_cast<unsigned char>(text(i))) == 0) {
            fail("the version is no number", i);
        }
    }

    std::vector<RawChunk> raw;
    bool hasDna = false;
    for (std::size_t at = headerBytes; !hasDna;) {
        RawChunk chunk;
        const auto length = static_cast<std::int32_t>(number(at + 4, 4));
        chunk.pointer = number(at + 8, m_pointerBytes);
        chunk.type = static_cast<std::int32_t>(number(at + 8 + m_pointerBytes, 4));
        const auto count = static_cast<std::int32_t>(number(at + 12 + m_pointerBytes, 4));
        chunk.code.assign(reinterpret_cast<const char*>(bytes.data()) + at, 4);
        chunk.begin = at + 16 + m_pointerBytes;
        if (length < 0 || static_cast<std::size_t>(length) > bytes.size() - chunk.begin) {
            fail("a chunk of " + std::to_string(length) + " bytes is longer than the file", at + 4);
        }
        if (count < 0) {
            fail("a chunk of " + std::to_string(count) + " structures", at + 12 + m_pointerBytes);
        }
        chunk.size = static_cast<std::size_t>(length);
        chunk.number = static_cast<std::uint64_t>(count);
        at = chunk.begin + chunk.size;
        if (chunk.code == "DNA1") {
            readDna(chunk.begin, at);
            hasDna = true;
        } else {
            raw.push_back(chunk);
        }
    }
    for (const RawChunk& chunk : raw) {
        BulletChunk& made = m_chunks.emplace_back();
        made.code = chunk.code;
        made.pointer = chunk.pointer;
        made.number = static_cast<std::size_t>(chunk.number);
        made.data = bytes.subspan(chunk.begin, chunk.size);
        if (chunk.type >= static_cast<std::int64_t>(m_structs.size())) {
            fail("structure " + std::to_string(chunk.type) + " is not described", chunk.begin - 8);
        }
        // Arrays of plain numbers name no structure that they hold.
        if (chunk.type >= 0) {
            const DnaStruct& type = m_structs[static_cast<std::size_t>(chunk.type)];
            if (type.size > 0 && chunk.number <= chunk.size / type.size) {
                made.type = &type;
            } else if (chunk.code != "ARAY") {
                fail(std::to_string(chunk.number) + " " + type.type + " do not fit into " + std::to_string(chunk.size) +
                         " bytes",
                     chunk.begin);
            }
        }
        m_byPointer.emplace(chunk.pointer, m_chunks.size() - 1);
    }
}

/// SDNA, NAME, TYPE, TLEN, STRC, each aligned to four bytes.
void BulletLayout::readDna(std::size_t begin, std::size_t end) {
    std::size_t at = begin;
    const auto tag = [&](const char* wanted) {
        at = begin + (at - begin + 3) / 4 * 4;
        if (at + 4 > end || std::memcmp(m_bytes.data() + at, wanted, 4) != 0) {
            fail(std::string("the description has no ") + wanted, at);
        }
        at += 4;
    };
    const auto count = [&](std::size_t bytes) {
        if (at + bytes > end) {
            fail("the description ends", at);
        }
        const std::uint64_t value = number(at, bytes);
        at += bytes;
        return static_cast<std::size_t>(value);
    };
    const auto strings = [&](const char* wanted) {
        tag(wanted);
        const std::size_t size = count(4);
        if (size > mostNames) {
            fail(std::to_string(size) + " names", at - 4);
        }
        std::vector<std::string> all(size);
        for (std::string& one : all) {
            while (at < end && m_bytes[at] != std::byte{0}) {
                one.push_back(static_cast<char>(m_bytes[at++]));
            }
            if (at++ >= end) {
                fail("the description ends within a name", end);
            }
        }
        return all;
    };
    tag("SDNA");
    const std::vector<std::string> names = strings("NAME");
    const std::vector<std::string> types = strings("TYPE");
    tag("TLEN");
    std::vector<std::size_t> lengths;
    for (std::size_t i = 0; i < types.size(); ++i) {
        lengths.push_back(count(2));
    }
    tag("STRC");
    const std::size_t structs = count(4);
    if (structs > mostNames) {
        fail(std::to_string(structs) + " structures", at - 4);
    }
    for (std::size_t s = 0; s < structs; ++s) {
        DnaStruct made;
        const std::size_t type = count(2);
        if (type >= types.size()) {
            fail("type " + std::to_string(type) + " has no name", at - 2);
        }
        made.type = types[type];
        made.size = lengths[type];
        std::size_t offset = 0;
        for (std::size_t left = count(2); left > 0; --left) {
            const std::size_t fieldType = count(2);
            const std::size_t fieldName = count(2);
            if (fieldType >= types.size() || fieldName >= names.size()) {
                fail("a member without type or name", at - 4);
            }
            DnaField field;
            field.type = types[fieldType];
            field.offset = offset;
            for (const char c : names[fieldName].substr(0, names[fieldName].find('['))) {
                c == '*' ? static_cast<void>(++field.pointers) : field.name.push_back(c);
            }
            for (std::size_t open = names[fieldName].find('['); open != std::string::npos;
                 open = names[fieldName].find('[', open + 1)) {
                field.elements *= static_cast<std::size_t>(std::atoi(names[fieldName].c_str() + open + 1));
            }
            if (field.elements == 0 || field.elements > mostNames) {
                fail("a member with " + std::to_string(field.elements) + " elements", at - 2);
            }
            field.size = field.elements * (field.pointers > 0 ? m_pointerBytes : lengths[fieldType]);
            offset += field.size;
            made.fields.push_back(std::move(field));
        }
        if (offset > made.size) {
            fail("the members of " + made.type + " are longer than it is", at);
        }
        m_byType.emplace(made.type, m_structs.size());
        m_structs.push_back(std::move(made));
    }
}

const BulletChunk* BulletLayout::at(std::uint64_t pointer) const {
    const auto found = m_byPointer.find(pointer);
    return found != m_byPointer.end() ? &m_chunks[found->second] : nullptr;
}

const DnaStruct* BulletLayout::structure(std::string_view type) const {
    const auto found = m_byType.find(std::string(type));
    return found != m_byType.end() ? &m_structs[found->second] : nullptr;
}

std::uint64_t BulletLayout::pointerAt(std::span<const std::byte> data, std::size_t offset) const {
    return number(offsetOf(data) + offset, m_pointerBytes);
}

std::size_t BulletLayout::offsetOf(std::span<const std::byte> data) const {
    return static_cast<std::size_t>(data.data() - m_bytes.data());
}

}  // namespace grapeshot::import::detail
