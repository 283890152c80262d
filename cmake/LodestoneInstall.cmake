# `cmake --install` gives a package that find_package(lodestone) uses.
