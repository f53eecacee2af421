# Output opened by other programs: VTK and h5py of Debian's own Python. Skipped with a message where they are absent.
find_program(EPAFI_SYSTEM_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH)
if(EPAFI_SYSTEM_PYTHON)
  add_test(NAME viz_export_read_back
    COMMAND ${EPAFI_SYSTEM_PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/viz_export/read_back.py $<TARGET_FILE:test_viz_export>)
else()
  add_test(NAME viz_export_read_back COMMAND ${CMAKE_COMMAND} -E echo "skipped: no /usr/bin/python3")
  set_tests_properties(viz_export_read_back PROPERTIES SKIP_REGULAR_EXPRESSION "skipped")
endif()
set_tests_properties(viz_export_read_back PROPERTIES SKIP_RETURN_CODE 77 LABELS "fast;viz_export" TIMEOUT 120)
