// The names of up axes, and turns from one to another.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "core/math/vec3.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

struct Affine3d;  // core/math/affine.h

inline constexpr std::array<std::string_view, 7> up_axis_names{"z", "y", "x", "-z", "-y", "-x", "earth"};

[[nodiscard]] constexpr std::string_view name_of(UpAxis axis) { return up_axis_names[static_cast<std::size_t>(axis)]; }
// The name, and that it is guessed.
[[nodiscard]] std::string text_of(Up up);
// A line for people whose model has an axis that nobody gave; empty for others.
[[nodiscard]] std::string guess_note(Up up);
// Empty for an unknown name.
[[nodiscard]] std::optional<UpAxis> up_axis_named(std::string_view name);
// One of the six axes, as --up names it. Throws InputError for other names.
[[nodiscard]] UpAxis up_axis(const std::string& name);

// The unit vector of it at a place in the space of the model.
[[nodiscard]] Vec3d direction_of(UpAxis axis, Vec3d place);

// The smallest turn that takes one unit vector to another: exact between axes.
[[nodiscard]] Affine3d turn_between(Vec3d from, Vec3d to);
// The same as a unit quaternion (x, y, z, w).
[[nodiscard]] std::array<double, 4> turn_quaternion(Vec3d from, Vec3d to);

}  // namespace lodestone
