# Comments of a header as Doxygen reads them: the first as that of the file, others as those of what follows, or of what
# stands before them on the line.
1s|^// ?(.*)|/// \\file\n/// \1|
/^} *\/\/ namespace/b
s|^( *)//( .*)?$|\1///\2|
s|([^ /].*[^ ]) +// (.*)$|\1  ///< \2|
