# cpack reads this first. For a tarball: the tree as it is committed, without what lies beside it.
if(CPACK_SOURCE_INSTALLED_DIRECTORIES AND CPACK_GENERATOR MATCHES "TGZ")
  set(folder ${CPACK_LODESTONE_BINARY}/source)
  file(REMOVE_RECURSE ${folder})
  file(MAKE_DIRECTORY ${folder})
  execute_process(COMMAND git -C ${CPACK_LODESTONE_SOURCE} archive --output ${folder}.tar HEAD COMMAND_ERROR_IS_FATAL ANY)
  file(ARCHIVE_EXTRACT INPUT ${folder}.tar DESTINATION ${folder})
  file(REMOVE ${folder}.tar)
endif()
