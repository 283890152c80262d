// Which program this is: what it is made of, and the hash of what it does.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace lodestone {

// SHA-256 of the code and data of this executable, its allocated sections (elf1995) but notes and the commit that it
// was built from, and of what identifies the libraries that decide results. A changed comment, another commit of the
// same code or debug information leave it as it is.
[[nodiscard]] const std::string& program_hash();

// The hash, version, commit, dirty, compiler, flags, build type, and all libraries that are loaded when it is called,
// for manifests.
[[nodiscard]] nlohmann::json program_facts();

}  // namespace lodestone
