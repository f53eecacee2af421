# Tests that mpirun starts; with EPAFI_MPI only.
find_program(EPAFI_MPIRUN mpirun REQUIRED)
file(GLOB rank_tests CONFIGURE_DEPENDS ranks/*.cpp)
add_executable(test_ranks ${rank_tests})
set_target_properties(test_ranks PROPERTIES UNITY_BUILD OFF EPAFI_HDF5_ARCHIVED ON)
target_link_libraries(test_ranks PRIVATE epafi::scenes epafi::ranks Catch2::Catch2 epafi_warnings)
target_include_directories(test_ranks PRIVATE ${PROJECT_SOURCE_DIR})
target_compile_definitions(test_ranks PRIVATE EPAFI_CHECK_CONTRACTS CATCH_CONFIG_FAST_COMPILE
  EPAFI_SOURCE_DIR="${PROJECT_SOURCE_DIR}" EPAFI_BINARY_DIR="${PROJECT_BINARY_DIR}")
target_compile_options(test_ranks PRIVATE -O1)
set(root_environment OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMP_NUM_THREADS=1
  OMP_WAIT_POLICY=passive)
foreach(ranks 1 2 3 4)
  add_test(NAME "partition, states and spheres of ${ranks} ranks" COMMAND ${EPAFI_MPIRUN} --oversubscribe --bind-to none
    --mca mpi_yield_when_idle 1 -n ${ranks} $<TARGET_FILE:test_ranks>)
  set_tests_properties("partition, states and spheres of ${ranks} ranks" PROPERTIES LABELS "fast;ranks" TIMEOUT 300
    PROCESSORS 2 ENVIRONMENT "${root_environment}")
endforeach()

add_test(NAME "ranks: every library scene on three" COMMAND ${EPAFI_MPIRUN} --oversubscribe --bind-to none
  --mca mpi_yield_when_idle 1 -n 3 $<TARGET_FILE:test_ranks> [library])
set_tests_properties("ranks: every library scene on three" PROPERTIES LABELS "slow;ranks" TIMEOUT 1800 PROCESSORS 2
  ENVIRONMENT "${root_environment}")

# steps SCENE [KEY=VALUE ...]: the hash of the program alone on all cases
function(epafi_same_bits name cases steps scene)
  add_test(NAME "ranks: ${name}" COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/ranks/same_bits.sh $<TARGET_FILE:epafi>
    $<TARGET_FILE:epafi-mpi> ${PROJECT_BINARY_DIR}/ranks/${name} "${cases}" ${steps}
    ${PROJECT_SOURCE_DIR}/${scene} ${ARGN})
  set_tests_properties("ranks: ${name}" PROPERTIES LABELS "fast;ranks" TIMEOUT 300 PROCESSORS 2)
endfunction()
epafi_same_bits(bed "1x2 2x2 3x1 4x1" 600 scenes/library/bed/bed.toml params.n=200)
epafi_same_bits(hopper "3x1" 300 scenes/library/hopper/hopper.toml params.n=200 params.open_at=0.01)
epafi_same_bits(mixed "2x1 3x1" 150 tests/ranks/mixed.toml)
epafi_same_bits(kinds "3x1" 105 tests/ranks/kinds.toml)
epafi_same_bits(acts "1x2 3x1" 1000 tests/ranks/acts.toml)
epafi_same_bits(presses "2x1 3x1 4x1" 1000 tests/ranks/presses.toml)
foreach(seed 1 2 3)
  epafi_same_bits(springs_${seed} "2x1 3x1" 1000 tests/ranks/springs.toml params.seed=${seed})
  epafi_same_bits(cell_${seed} "2x1 3x1" 1000 tests/ranks/cell.toml params.seed=${seed})
  epafi_same_bits(pressed_cell_${seed} "2x1 3x1" 1000 tests/ranks/pressed_cell.toml params.seed=${seed})
endforeach()
# non-smooth contact: contacts are found by all ranks, impulses by the first
set(library scenes/library)
epafi_same_bits(stack "3x1" 150 ${library}/stacking/stack.toml)
epafi_same_bits(arch "2x1 3x1" 150 ${library}/stability/arch.toml params.ratio=0.08)
epafi_same_bits(stones "1x2 2x2 3x1" 150 ${library}/pile/polyhedra.toml params.n=60)
epafi_same_bits(cards "3x1" 120 ${library}/stability/card_house.toml)
epafi_same_bits(balls "3x1" 60 ${library}/simbenchmark/balls_666.toml)
epafi_same_bits(impulses "1x2 3x1 4x1" 160 tests/ranks/impulses.toml)
epafi_same_bits(hard_acts "1x2 3x1" 1000 tests/ranks/acts.toml contact.method=nonsmooth)
epafi_same_bits(arch_acts "3x1" 400 ${library}/stages/tilted_arch.toml)
add_test(NAME "ranks: drawn scenes" COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/ranks/drawn_scenes.sh $<TARGET_FILE:epafi>
  $<TARGET_FILE:epafi-mpi> ${PROJECT_BINARY_DIR}/ranks/drawn_scenes "2x1 3x1" 2 15)
set_tests_properties("ranks: drawn scenes" PROPERTIES LABELS "fast;ranks" TIMEOUT 300 PROCESSORS 2)
add_test(NAME "ranks: drawn kills" COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/ranks/drawn_kills.sh $<TARGET_FILE:epafi>
  $<TARGET_FILE:epafi-mpi> ${PROJECT_BINARY_DIR}/ranks/drawn_kills 2 6)
set_tests_properties("ranks: drawn kills" PROPERTIES LABELS "fast;ranks" TIMEOUT 300 PROCESSORS 2)
add_test(NAME "ranks: faults" COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/ranks/faults.sh $<TARGET_FILE:epafi>
  $<TARGET_FILE:epafi-mpi> ${PROJECT_BINARY_DIR}/ranks/faults ${PROJECT_SOURCE_DIR}/scenes/library/bed/bed.toml
  ${PROJECT_SOURCE_DIR}/tests/ranks/impulses.toml)
set_tests_properties("ranks: faults" PROPERTIES LABELS "fast;ranks" TIMEOUT 300 PROCESSORS 2)
add_test(NAME "ranks: slurm job" COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/ranks/slurm_job.sh $<TARGET_FILE:epafi>
  $<TARGET_FILE:epafi-mpi> ${PROJECT_BINARY_DIR}/ranks/slurm_job ${PROJECT_SOURCE_DIR}/docs/ranks.sbatch
  ${PROJECT_SOURCE_DIR}/scenes/library/bed/bed.toml)
set_tests_properties("ranks: slurm job" PROPERTIES LABELS "fast;ranks" TIMEOUT 120 PROCESSORS 2)
