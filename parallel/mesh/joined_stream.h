// Several meshes as one, in their order.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "parallel/mesh/mesh_stream.h"

namespace lodestone {

// The first file, and how many others there are: for messages about all of them.
[[nodiscard]] std::string name_of_files(std::span<const std::filesystem::path> files);

// `up` is that of the files before, `name` the file that has another one, perhaps. Throws InputError if so.
void require_same_up(Up up, Up of_file, const std::string& name);

// At least one part. Vertices and triangles are numbered through; attributes are not joined. Throws ResourceError for
// more vertices than 32-bit ids reach. What is wrong with a part is told with its own name.
[[nodiscard]] std::unique_ptr<MeshStream> join_streams(std::vector<std::unique_ptr<MeshStream>>&& parts,
                                                       std::string name);

}  // namespace lodestone
