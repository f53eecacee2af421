# The scorecard of perf/scorecard: bodies, measures and pages without any engine; and a short run of ours and of ODE
# where that is installed.
find_program(EPAFI_SYSTEM_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH)
if(EPAFI_SYSTEM_PYTHON)
  set(scorecard ${EPAFI_SYSTEM_PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/package/scorecard.py)
  add_test(NAME "bodies, measures and pages of the scorecard hold" COMMAND ${scorecard} read)
  set_tests_properties("bodies, measures and pages of the scorecard hold" PROPERTIES LABELS "fast;documents"
    TIMEOUT 120)
  if(EPAFI_PERF)
    add_test(NAME "the scorecard runs, with one peer where it is installed" COMMAND ${scorecard} run
      ${PROJECT_BINARY_DIR})
    set_tests_properties("the scorecard runs, with one peer where it is installed" PROPERTIES LABELS package
      TIMEOUT 600)
  endif()
endif()
